// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/evaluation_suite.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "overtone/client/cli/recorded_suites.h"
#include "overtone/client/cli/simulated_experiment.h"

namespace overtone {
namespace {

ScenarioOptions Scene(const std::string& scene, int num_robots) {
  ScenarioOptions scenario;
  scenario.scene = scene;
  scenario.num_robots = num_robots;
  return scenario;
}

// Bernreiter et al. 2024, "Experiments": where onboard estimators fail, and what a server makes of
// it.
EvaluationSuite Paper() {
  ScenarioOptions terrace = Scene("terrace", 4);
  terrace.failures.yaw_drift = true;
  ScenarioOptions corridor = Scene("corridor", 2);
  corridor.failures.degenerate = true;
  corridor.num_failing = 1;  // closures alone tell nobody how long a corridor is that all shorten
  ScenarioOptions jump = Scene("tunnel", 4);
  jump.failures.jump = true;
  return {"paper",
          "The paper's experiments in simulation",
          {SimulatedExperiment(
               "indoor_outdoor_drift",
               "a building and the terrace before it, 4 robots; on the terrace the heading of each "
               "drifts by 2 mrad/s",
               terrace),
           SimulatedExperiment(
               "degenerate_tunnel",
               "160 m of bare corridor, 2 robots; robot1 measures 70 % of its motion along it and "
               "flags those keyframes with the direction, robot2 has ordinary drift of 1 %",
               corridor),
           SimulatedExperiment("sudden_jump",
                               "a hall, rooms and tunnels, 4 robots; the estimate of each jumps "
                               "once by 1.5 m and 0.15 rad",
                               jump),
           SimulatedExperiment("tunnel_urban_cave",
                               "tunnels, an urban grid and a cave around one hall, 4 robots, 2 km; "
                               "ordinary drift of 1 %",
                               Scene("subterranean", 4))}};
}

EvaluationSuite Smoke() {
  ScenarioOptions scenario = Scene("tunnel", 2);
  scenario.length_m = 40;
  return {"smoke",
          "Does everything work? Two robots, 40 m each",
          {SimulatedExperiment("smoke", "the tunnel scene's hall, 2 robots, 40 m each", scenario)}};
}

}  // namespace

const std::vector<EvaluationSuite>& EvaluationSuites() {
  static const auto* const suites = [] {
    auto* suites = new std::vector<EvaluationSuite>{Paper(), Smoke()};
    for (EvaluationSuite& suite : RecordedSuites()) suites->push_back(std::move(suite));
    return suites;
  }();
  return *suites;
}

absl::StatusOr<const EvaluationSuite*> FindEvaluationSuite(absl::string_view name) {
  std::vector<std::string> names;
  for (const EvaluationSuite& suite : EvaluationSuites()) {
    if (suite.name == name) return &suite;
    names.push_back(suite.name);
  }
  return absl::InvalidArgumentError(
      absl::StrCat("no suite \"", name, "\"; there are: ", absl::StrJoin(names, ", ")));
}

}  // namespace overtone
