// SPDX-License-Identifier: Apache-2.0
// An experiment whose data a simulation makes.
#ifndef OVERTONE_CLIENT_CLI_SIMULATED_EXPERIMENT_H_
#define OVERTONE_CLIENT_CLI_SIMULATED_EXPERIMENT_H_

#include <string>

#include "overtone/client/cli/evaluation_suite.h"
#include "overtone/core/simulation/scenario.h"

namespace overtone {

// Writes the scenario, under the experiment's seed, to <folder>/data (simulation_files.h), and
// plays it as `overtone replay --dataset pcd <folder>/data`: clouds and odometry go to the server,
// which finds the loop closures itself; the ground truth only judges.
Experiment SimulatedExperiment(std::string name, std::string title, ScenarioOptions scenario);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_SIMULATED_EXPERIMENT_H_
