// SPDX-License-Identifier: Apache-2.0
// The way of a loop candidate to its verdict. In the order of cost:
//   its own figures       score, overlap, residual, open directions          JudgeFigures
//   odometry              within a mission: no further off than it can drift MultiRobotMap
//   pairwise consistency  between two missions: the largest consistent set
//   quarantine            a first tie between two components needs company
//   the map as it stands  what leaves a direction open must be expected
//   the optimiser         graduated non-convexity, then a chi-square test
// and an operator's word above all of them. A verdict may change with every revision, but for
// those on figures.
#ifndef OVERTONE_CORE_MAPPING_LOOP_CLOSURE_H_
#define OVERTONE_CORE_MAPPING_LOOP_CLOSURE_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "overtone/core/graph/submap.h"
#include "overtone/core/place_recognition/loop_candidate.h"

namespace overtone {

enum class ClosureVerdict {
  kPending,               // an end is not in the map yet
  kAccepted,              // used, at full or nearly full weight
  kDemotedByOptimiser,    // contradicts the rest of the map; its weight went to zero
  kQuarantined,           // would tie two components, and too few consistent ones agree with it yet
  kRejectedScore,         // the places do not look alike enough
  kRejectedOverlap,       // the registered clouds share too little
  kRejectedResidual,      // the registered clouds lie too far apart
  kRejectedDegenerate,    // the clouds leave too much of the relative pose open
  kRejectedInconsistent,  // not in the largest consistent set between its two missions
  kVetoedByOperator,
  kForcedByOperator,  // used, whatever the checks say
};

// All verdicts, in the order above.
const std::vector<ClosureVerdict>& AllClosureVerdicts();

// "pending", "accepted", "demoted_by_optimiser", ...
absl::string_view ToString(ClosureVerdict verdict);

inline bool InUse(ClosureVerdict verdict) {
  return verdict == ClosureVerdict::kAccepted || verdict == ClosureVerdict::kForcedByOperator;
}

struct ClosureRecord {
  std::string id;  // "robot/mission:index>robot/mission:index#n", unique in the map
  LoopCandidate candidate;
  ClosureVerdict verdict = ClosureVerdict::kPending;
  double weight = 0;            // [0, 1], of the robust optimisation
  double chi_square = 0;        // r^T Omega r after it, 6 degrees of freedom
  uint64_t since_revision = 0;  // that gave this verdict
  // Size of the set that decided: consistent closures between its missions.
  int consistent_set = 0;
};

// True when the clouds leave a direction open, as a corridor does along its axis. One corridor is
// like another, so such a closure proves nothing by itself: it ties no components and vouches for
// no other closure, and it is used where the map expects it, as weakly as it was measured.
inline bool IsWeak(const LoopCandidate& candidate) {
  return candidate.registration.has_value() && candidate.registration->open_directions > 0;
}

// Inverse covariance for the optimiser. Along a direction that the clouds leave open the measured
// pose is but the guess, and a hundred guesses would pull together what odometry is unsure of: such
// a direction gets no information at all.
Matrix6d InformationOf(const LoopCandidate& candidate);

// What the figures alone say: one of the kRejected ones, or kPending when they are in order.
ClosureVerdict JudgeFigures(const LoopCandidate& candidate);

// Why the verdict is what it is: a sentence without a full stop.
std::string Reason(const ClosureRecord& record);

// A robot's measured closure as a candidate; it has passed the robot's own checks.
LoopCandidate CandidateOf(const LoopClosure& closure);

// A scored pair without a relative pose as a weak one: the same place within position_sigma_m, any
// heading.
LoopCandidate WeakCandidateOf(const ScoredCandidate& candidate, double score_threshold,
                              double position_sigma_m);

// The same measurement told from its other end.
LoopCandidate Reversed(const LoopCandidate& candidate);

// True when `covariance` says next to nothing of the rotation (some standard deviation above 1
// rad).
bool RotationIsOpen(const Matrix6d& covariance);

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_LOOP_CLOSURE_H_
