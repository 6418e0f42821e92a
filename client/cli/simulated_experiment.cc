// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/simulated_experiment.h"

#include <iostream>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "overtone/client/cli/simulation_files.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

void Report(const SimulatedFolder& robot) {
  std::cerr << absl::StreamFormat("Simulated %s: %d keyframes over %.0f m, %d points\n", robot.name,
                                  robot.num_keyframes, robot.path_m, robot.num_points);
}

}  // namespace

Experiment SimulatedExperiment(std::string name, std::string title, ScenarioOptions scenario) {
  const auto prepare = [scenario = std::move(scenario)](
                           const std::string& folder, uint64_t seed,
                           const std::string& /*data*/) -> absl::StatusOr<ReplayOptions> {
    ScenarioOptions seeded = scenario;
    seeded.seed = seed;
    const std::string data = absl::StrCat(folder, "/data");
    RETURN_IF_ERROR(WriteSimulation(seeded, LidarOptions(), data, Report).status());
    ReplayOptions replay;
    replay.dataset = DatasetKind::kPcd;
    replay.dataset_name = "pcd";
    replay.sensor_files.paths = {data};
    replay.command_line = absl::StrCat("dataset=pcd\npath=", data, "\n");
    return replay;
  };
  return {std::move(name), std::move(title), prepare};
}

}  // namespace overtone
