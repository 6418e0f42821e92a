// SPDX-License-Identifier: Apache-2.0
// The server's estimate of a mission beside the robot's own: where and at which scale do they
// disagree? Bernreiter et al. 2024, "Discrepancy detection".
#ifndef OVERTONE_CORE_SYNCHRONIZATION_TRAJECTORY_COMPARISON_H_
#define OVERTONE_CORE_SYNCHRONIZATION_TRAJECTORY_COMPARISON_H_

#include <cstdint>
#include <vector>

#include "Eigen/Core"
#include "overtone/core/synchronization/node_association.h"

namespace overtone {

enum class Band {
  kLarge = 0,
  kMid = 1,
  kSmall = 2
};  // columns of `discrepancy`; low to high graph frequency

// One row per associated node, in order of the keyframe index. All vectors but `unmatched` have the
// same length n.
struct TrajectoryComparison {
  std::vector<int64_t> keyframe_index;
  std::vector<Rigid3d> server;   // map_from_body
  std::vector<Rigid3d> onboard;  // estimate_from_body, another frame
  std::vector<bool> submap_start;
  std::vector<bool> degenerate;
  Eigen::MatrixXd discrepancy;  // n x 3, summed |W_server - W_robot| per Band, units of the signal
  // The robot's keyframes that the server's graph does not hold, index increasing: thinned out
  // there, or not mapped yet.
  std::vector<NodePose> unmatched;
  uint64_t revision = 0;
  uint64_t map_epoch = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_TRAJECTORY_COMPARISON_H_
