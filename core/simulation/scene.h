// SPDX-License-Identifier: Apache-2.0
// The places where simulated teams drive.
#ifndef OVERTONE_CORE_SIMULATION_SCENE_H_
#define OVERTONE_CORE_SIMULATION_SCENE_H_

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "Eigen/Core"
#include "Eigen/Geometry"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "overtone/core/simulation/floor_plan.h"
#include "overtone/core/simulation/navigation_graph.h"

namespace overtone {

struct Scene {
  FloorPlan plan;
  NavigationGraph graph;                 // drivable
  std::vector<std::vector<int>> routes;  // the scripted team's, a walk for each robot

  // Where sensors fail, seen from above.
  std::optional<Eigen::AlignedBox2d> terrace;   // open ground: nothing to hold the heading by
  std::optional<Eigen::AlignedBox2d> corridor;  // bare walls along x: nothing to tell the way by
};

// Names for MakeScene:
//   tunnel         a hall of pillars, five rooms and the rough tunnels between them; 4 robots
//   terrace        a building and a terrace of 200 m x 200 m before it; 3 robots
//   corridor       two different rooms and 160 m of bare corridor between them; 2 robots
//   subterranean   tunnels, an urban grid and a cave around one hall; 4 robots, 2 km in all
const std::vector<std::string>& SceneNames();

// `seed` moves walls, ground and clutter; the layout stays. InvalidArgument: no such scene.
absl::StatusOr<Scene> MakeScene(absl::string_view name, uint64_t seed);

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_SCENE_H_
