// SPDX-License-Identifier: Apache-2.0
// What a robot uploads: a run of consecutive keyframes of one mission and the loop closures it
// knows of.
#ifndef OVERTONE_CORE_GRAPH_SUBMAP_H_
#define OVERTONE_CORE_GRAPH_SUBMAP_H_

#include <cstdint>
#include <vector>

#include "overtone/core/common/ids.h"
#include "overtone/core/common/timestamp.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

struct Keyframe {
  Timestamp stamp;  // robot clock, strictly increasing within a mission
  // Odometry, metres; never corrected by the server's constraints, else they would be counted
  // twice.
  Rigid3d mission_from_body;
  // Covariance of the motion from the previous keyframe to this one (right tangent, m^2 and rad^2),
  // positive definite. The mission's first keyframe has no previous one; its value is not read.
  Matrix6d motion_covariance = Matrix6d::Identity();
  // The robot's own word that this motion was poorly observed (corridor, slip).
  bool degenerate = false;
};

// A measured relative pose between two keyframes, of one mission or of two.
struct LoopClosure {
  NodeId from;
  NodeId to;
  Rigid3d from_tform_to;
  Matrix6d covariance = Matrix6d::Identity();  // right tangent of from_tform_to, positive definite
};

struct Submap {
  int64_t sequence = 0;  // counts from 0 per mission, without gaps
  int64_t first_index =
      0;  // index of keyframes[0] in the mission; follows the previous submap's last
  std::vector<Keyframe> keyframes;
  std::vector<LoopClosure> loop_closures;  // at least one end in this mission
};

}  // namespace overtone

#endif  // OVERTONE_CORE_GRAPH_SUBMAP_H_
