// SPDX-License-Identifier: Apache-2.0
// Which node of the server's graph is which keyframe of the robot's own estimate.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_NODE_ASSOCIATION_H_
#define OVERTONE_CORE_SYNCHRONIZATION_NODE_ASSOCIATION_H_

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/common/timestamp.h"
#include "overtone/core/geometry/se3.h"
#include "overtone/core/graph/map_graph.h"

namespace overtone {

// One keyframe as the robot's own estimator sees it now.
struct NodePose {
  int64_t index = 0;  // the keyframe index it was uploaded under
  Timestamp stamp;
  Rigid3d estimate_from_body;  // any fixed frame of the robot's; only relative poses are compared
};

// Positions in MapMission::nodes and in the onboard trajectory.
struct NodeMatch {
  int server = 0;
  int onboard = 0;
};

// `trajectory` in order of the keyframe index, with unit quaternions.
// InvalidArgument naming the index: negative, given twice, a value that is not finite, or a
// quaternion whose length is not 1 within a thousandth.
absl::StatusOr<std::vector<NodePose>> CheckedTrajectory(std::vector<NodePose> trajectory);

// One-to-one, both positions increasing. By keyframe index where every server node carries one (>=
// 0); otherwise by stamp, the closest pairs first, at most tolerance_s apart, and pairs that would
// go back in time left out. onboard: index increasing. O(n log n).
//
// The paper's prototype lets several server nodes share one onboard pose and reads only the first
// min(n) of them.
std::vector<NodeMatch> AssociateNodes(const MapMission& mission,
                                      const std::vector<NodePose>& onboard, double tolerance_s);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_NODE_ASSOCIATION_H_
