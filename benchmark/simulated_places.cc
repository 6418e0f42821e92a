// SPDX-License-Identifier: Apache-2.0
#include "overtone/benchmark/simulated_places.h"

#include <cstdlib>
#include <utility>

#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/core/simulation/scenario.h"

namespace overtone {

std::vector<SimulatedPlace> SimulatePlaces(int count, double aside_m, uint64_t seed) {
  static const Scenario scenario = [] {
    ScenarioOptions options;
    options.scene = "subterranean";
    options.num_robots = 1;
    return *SimulateScenario(options);
  }();
  const Lidar lidar = *Lidar::Create({});
  const Trajectory& way = scenario.robots[0].ground_truth;
  if (static_cast<int>(way.size()) < count) std::abort();
  Random random(seed);
  std::vector<SimulatedPlace> places;
  for (int i = 0; i < count; ++i) {
    const Rigid3d world_from_body =
        way[i].pose * Rigid3d(Eigen::Quaterniond::Identity(), {0, aside_m, 0});
    const PointCloud scan = lidar.Scan(scenario.world, world_from_body, random);
    auto blob = std::make_shared<const std::string>(*EncodePointCloud(scan, {}));
    places.push_back(
        {world_from_body, std::make_shared<const PointCloud>(*DecodePointCloud(*blob)), blob});
  }
  return places;
}

}  // namespace overtone
