// SPDX-License-Identifier: Apache-2.0
// A pair of keyframes that may be the same place, and what came of looking closer. Every kind of
// evidence takes this way: a proposer names pairs, a verifier measures their relative pose, the map
// decides (mapping/loop_closure.h). A new kind (visual submaps, say) is one more of each.
#ifndef OVERTONE_CORE_PLACE_RECOGNITION_LOOP_CANDIDATE_H_
#define OVERTONE_CORE_PLACE_RECOGNITION_LOOP_CANDIDATE_H_

#include <optional>

#include "overtone/core/common/ids.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

enum class LoopEvidence {
  kRobot,        // the robot's front end, with a relative pose
  kRobotScore,   // the robot's front end, with a score only
  kScanContext,  // the server, from point clouds
};

// What the registration of two clouds gave, and what it had to give.
struct RegistrationFigures {
  bool converged = false;
  double overlap = 0;  // share of the points that have a counterpart, [0, 1]
  double overlap_threshold = 0;
  double residual_m = 0;  // rms distance to the counterpart's surface
  double residual_limit_m = 0;
  int open_directions = 0;  // of the six, those that the clouds do not determine
};

struct LoopCandidate {
  NodeId from;
  NodeId to;
  LoopEvidence proposer = LoopEvidence::kRobot;
  double score = 0;  // similarity, [0, 1]; of no meaning for kRobot
  double score_threshold = 0;
  // The proposer's guess, then the verifier's measurement.
  Rigid3d from_tform_to;
  Matrix6d covariance = Matrix6d::Identity();  // right tangent
  bool measured = false;                       // from_tform_to may be used
  std::optional<RegistrationFigures> registration;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_PLACE_RECOGNITION_LOOP_CANDIDATE_H_
