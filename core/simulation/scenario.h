// SPDX-License-Identifier: Apache-2.0
// A team of robots that drive through a simulated world (scene.h): where they were, what their
// odometry says of it, and from where their LiDAR looked.
#ifndef OVERTONE_CORE_SIMULATION_SCENARIO_H_
#define OVERTONE_CORE_SIMULATION_SCENARIO_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/geometry/trajectory.h"
#include "overtone/core/graph/node_selection.h"
#include "overtone/core/graph/point_cloud.h"
#include "overtone/core/simulation/lidar.h"
#include "overtone/core/simulation/odometry_failures.h"
#include "overtone/core/simulation/odometry_noise.h"
#include "overtone/core/simulation/scene.h"
#include "overtone/core/simulation/world.h"

namespace overtone {

struct ScenarioOptions {
  std::string scene = "tunnel";  // of SceneNames()
  int num_robots = 0;            // 1..100; 0: as many as the scene has scripted routes
  uint64_t seed = 1;             // of the world, the ways, the noise of odometry and LiDAR
  // Off: robot i follows the scene's i-th route; robots beyond the last explore. On: all explore,
  // always onto the way they took least often.
  bool explore = false;
  double length_m = 0;   // of each run, up to 1e5; 0: the whole route, and 300 m where one explores
  double speed_mps = 1;  // 0.1..10
  double rate_hz = 10;   // poses a second between which odometry errs, 1..1000
  double body_height_m = 0.5;  // of the body's origin above the ground, 0..2
  KeyframeSelectionOptions keyframes = {1.5, 0.5};
  // A LiDAR odometry: about 1 % of the way.
  OdometryNoise odometry = {0.01, 3e-4, 1e-4, 1e-5, 0.003};
  OdometryFailures failures;
  int num_failing = 0;  // the first so many robots have them; 0: all

  // InvalidArgument naming the member.
  absl::Status Validate() const;
};

struct DegenerateKeyframe {
  int index = 0;              // in ScenarioRobot's trajectories
  Eigen::Vector3d direction;  // unit, in that keyframe's body frame: along this its motion is wrong
};

// Keyframes only. The body's x points forward, z up.
struct ScenarioRobot {
  std::string name;         // "robot1", "robot2", ...
  Trajectory odometry;      // odometry_from_body, a frame of its own: the first pose is identity
  Trajectory ground_truth;  // world_from_body, one world for the team; same stamps
  // With OdometryFailures::degenerate: those whose motion from the keyframe before leads through
  // the corridor.
  std::vector<DegenerateKeyframe> degenerate;
  uint64_t scan_seed = 0;

  // The scan of one keyframe, taken in an instant; in any order the same.
  PointCloud Scan(const World& world, const Lidar& lidar, int keyframe) const;
};

struct Scenario {
  Scene scene;
  World world;
  std::vector<ScenarioRobot> robots;
};

// All robots start at the same stamp, near the scene's common place, and keep at least 0.3 m off
// every surface. The same options give the same scenario on every platform, up to the last bits of
// its sin, cos and log. InvalidArgument: options.Validate(); a failure for which the scene has no
// place.
absl::StatusOr<Scenario> SimulateScenario(const ScenarioOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_SCENARIO_H_
