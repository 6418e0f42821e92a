// SPDX-License-Identifier: Apache-2.0
// What `overtone simulate` leaves behind: for each robot a folder of keyframes as a LiDAR-inertial
// odometry would have written it, and what was asked for.
#ifndef OVERTONE_CLIENT_CLI_SIMULATION_FILES_H_
#define OVERTONE_CLIENT_CLI_SIMULATION_FILES_H_

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/simulation/lidar.h"
#include "overtone/core/simulation/scenario.h"

namespace overtone {

struct SimulatedFolder {
  std::string name;  // of the robot and its folder
  int num_keyframes = 0;
  double path_m = 0;  // true, over keyframes
  int64_t num_points = 0;
  int num_degenerate = 0;
};

// Simulates, and writes into `folder`, which is made when missing:
//
//   scenario.json             all options, the scene's special places, the robots
//   robot1/Scans/000000.pcd   one cloud for each keyframe, body frame
//   robot1/odom_poses.txt     odometry_from_body of each keyframe, 3x4 row-major, 12 numbers
//   robot1/times.txt          seconds, nine decimals
//   robot1/ground_truth.txt   as odom_poses.txt, world_from_body, one world for all robots
//   robot1/degenerate.txt     rows "keyframe x y z", direction in the body frame; only when any
//
// `report` is called after each robot. InvalidArgument: options; the folder is not empty, for old
// scans must not pass for new ones. Unavailable: cannot be written.
absl::StatusOr<std::vector<SimulatedFolder>> WriteSimulation(
    const ScenarioOptions& scenario, const LidarOptions& lidar, const std::string& folder,
    const std::function<void(const SimulatedFolder&)>& report);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_SIMULATION_FILES_H_
