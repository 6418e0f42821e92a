// SPDX-License-Identifier: Apache-2.0
// What the client hands to the host's estimator.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_CONSTRAINT_H_
#define OVERTONE_CORE_SYNCHRONIZATION_CONSTRAINT_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

// At which scale the discrepancy was found. Bernreiter et al. 2024, "Constraint generation".
enum class ConstraintKind {
  kSmall,       // direct neighbours
  kMid,         // a few hops
  kLarge,       // pivots of other submaps
  kDegenerate,  // across a stretch the robot flagged degenerate
  kChord,       // between consecutive knots of a partition of the mission
};

absl::string_view ToString(ConstraintKind kind);  // "small", "mid", ...

// "mid:5-15": what a constraint of this kind between these keyframes is always called.
std::string ConstraintId(ConstraintKind kind, int64_t from, int64_t to);

// A relative pose between two keyframes of the robot's own mission, taken from the server's
// estimate.
struct Constraint {
  std::string
      id;  // deterministic: the same kind and nodes always give the same id, e.g. "mid:5-15"
  ConstraintKind kind = ConstraintKind::kSmall;
  int64_t from = 0;  // keyframe indices
  int64_t to = 0;
  Rigid3d from_tform_to;
  // Right tangent, translation first: [rho; phi]. GTSAM orders rotation first: swap the 3x3 blocks
  // for its Pose3, as docs/integrating.md shows.
  Matrix6d covariance = Matrix6d::Identity();
  double score = 0;  // the discrepancy that asked for it, in units of the signal
  uint64_t revision = 0;
};

// All changes one comparison asks for, to be applied together: one relinearisation instead of one
// per constraint.
struct ConstraintBatch {
  uint64_t revision = 0;
  uint64_t map_epoch = 0;
  std::vector<Constraint> add;
  std::vector<Constraint> update;    // known id, new transform
  std::vector<std::string> retract;  // ids that the server's estimate no longer supports

  // How the newest keyframe is predicted to move, as the host sees it, and in how many seconds that
  // may be blended into what controllers are given, by SynchronizationOptions::blend
  // (correction_blend.h has a helper). The estimate itself is to be corrected at once. 0: no
  // prediction could be made.
  double newest_move_m = 0;
  double newest_turn_rad = 0;
  double blend_s = 0;

  bool empty() const { return add.empty() && update.empty() && retract.empty(); }
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_CONSTRAINT_H_
