// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "Eigen/Cholesky"
#include "overtone/core/mapping/multi_robot_map_state.h"

namespace overtone {
namespace {

// consistency_row of a closure that has none.
constexpr int kNoRow = -1;
constexpr int kAgreesWithSet = -2;  // came when the set was full
constexpr int kDisagreesWithSet = -3;
// Closures of one pair of missions that are all compared with each other, O(n^2) in time and bits;
// of later ones each is compared with a sample of the set that these have made.
constexpr int kMaxRows = 3000;
constexpr size_t kSampledMembers = 100;

// How far from where the map has it a closure with an open direction may lie.
constexpr double kMaxWeakErrorM = 5;
constexpr double kMaxWeakErrorRad = 0.3;

// Chi square, 6 degrees of freedom, of the loop that a closure makes with its mission's odometry.
double LoopChiSquare(const LoopCandidate& closure, const UncertainTrajectory& odometry) {
  const int from = static_cast<int>(closure.from.index), to = static_cast<int>(closure.to.index);
  const Rigid3d loop = closure.from_tform_to.Inverse() * odometry.Relative(from, to);
  // z Exp(d) on the left of the loop is Ad(loop^-1) d on its right.
  const Matrix6d adjoint = Adjoint(loop.Inverse());
  const Matrix6d covariance =
      odometry.Covariance(from, to) + adjoint * closure.covariance * adjoint.transpose();
  const Vector6d error = Log(loop);
  return error.dot(covariance.ldlt().solve(error));
}

InterMissionClosure From(const LoopCandidate& candidate, bool reversed) {
  const LoopCandidate told = reversed ? Reversed(candidate) : candidate;
  return {static_cast<int>(told.from.index), static_cast<int>(told.to.index), told.from_tform_to,
          told.covariance};
}

}  // namespace

// Whether a closure agrees with most of an even sample of the set's members.
bool MultiRobotMap::State::AgreesWithMost(const InterMissionClosure& closure,
                                          const std::vector<InterMissionClosure>& rows,
                                          const std::vector<int>& members,
                                          const UncertainTrajectory& a,
                                          const UncertainTrajectory& b) const {
  const size_t stride = std::max<size_t>(1, members.size() / kSampledMembers);
  int agree = 0, asked = 0;
  for (size_t i = 0; i < members.size(); i += stride, ++asked) {
    agree += ConsistencyChiSquare(closure, rows[members[i]], a, b) <=
             options.consistency_chi_square_limit;
  }
  return 2 * agree > asked;
}

// Wants a say in the consistency of its two missions: all but those that figures or an operator
// have decided, and those that leave the rotation open. A loop through one of these is uncertain by
// as much as it is long, so they agree with anything.
bool MultiRobotMap::State::TakesPartInConsistency(int closure) const {
  const ClosureRecord& record = closures[closure];
  if (!BetweenMissions(record) || record.verdict == ClosureVerdict::kForcedByOperator) return false;
  if (IsWeak(record.candidate) || RotationIsOpen(record.candidate.covariance)) return false;
  return InPlay(closure) || record.verdict == ClosureVerdict::kRejectedInconsistent;
}

// Within a mission a closure must be within what its odometry can have drifted in between.
void MultiRobotMap::State::JudgeAgainstOdometry() {
  for (int k = 0; k < static_cast<int>(closures.size()); ++k) {
    ClosureRecord& record = closures[k];
    if (BetweenMissions(record) || consistency_row[k] >= 0 || !InPlay(k)) continue;
    if (record.verdict == ClosureVerdict::kForcedByOperator) continue;
    if (RotationIsOpen(record.candidate.covariance)) continue;
    consistency_row[k] = 0;  // odometry does not change: once is enough
    const UncertainTrajectory& path = odometry[PositionOf(record.candidate.from)];
    if (LoopChiSquare(record.candidate, path) <= options.consistency_chi_square_limit) continue;
    consistency_row[k] = -1;
    SetVerdict(record, ClosureVerdict::kRejectedInconsistent);
    record.weight = 0;
  }
}

// Odometry is what closures are compared along, as uploaded or made finer by scans: an optimised
// path would already have been bent by those accepted before.
void MultiRobotMap::State::JudgeConsistency() {
  if (options.robust != MultiRobotMapOptions::Robust::kGnc) return;
  JudgeAgainstOdometry();
  std::map<std::pair<int, int>, std::vector<int>> closures_of_missions;
  std::set<std::pair<int, int>> changed;  // a closure dropped out: its row must go
  for (int k = 0; k < static_cast<int>(closures.size()); ++k) {
    if (closures[k].verdict == ClosureVerdict::kPending || !BetweenMissions(closures[k])) continue;
    const std::pair<int, int> pair =
        std::minmax(PositionOf(closures[k].candidate.from), PositionOf(closures[k].candidate.to));
    if (TakesPartInConsistency(k)) {
      closures_of_missions[pair].push_back(k);
    } else if (consistency_row[k] != kNoRow) {
      consistency_row[k] = kNoRow;
      changed.insert(pair);
    }
  }
  for (const std::pair<int, int>& pair : changed) {
    consistency.erase(pair);
    for (const int k : closures_of_missions[pair]) consistency_row[k] = kNoRow;
  }
  bool lost = !changed.empty();
  std::vector<int> regained;
  for (const auto& [pair, closures_of_pair] : closures_of_missions) {
    if (!closures_of_pair.empty()) lost |= JudgePair(pair, closures_of_pair, regained);
  }
  // What held two missions together may be gone: they are aligned afresh by what is left. What has
  // come back did not hold them: it has to join them first.
  if (lost) SplitFrames();
  for (const int k : regained) {
    SetVerdict(closures[k], ClosureVerdict::kAccepted);
    closures[k].weight = 1;
  }
}

// True when a closure that was in use is so no longer. Those that were not consistent and now are
// are added to `regained`.
bool MultiRobotMap::State::JudgePair(const std::pair<int, int>& pair,
                                     const std::vector<int>& closures_of_pair,
                                     std::vector<int>& regained) {
  // The set changes with what is added to it, and with nothing else.
  const bool nothing_new = std::none_of(closures_of_pair.begin(), closures_of_pair.end(),
                                        [this](int k) { return consistency_row[k] == kNoRow; });
  if (nothing_new) return false;
  PairwiseConsistencyOptions consistency_options;
  consistency_options.chi_square_limit = options.consistency_chi_square_limit;
  const auto [entry, fresh] = consistency.try_emplace(pair, consistency_options);
  PairwiseConsistency& set = entry->second;
  const UncertainTrajectory &a = odometry[pair.first], &b = odometry[pair.second];
  std::vector<InterMissionClosure> rows(set.Size());
  std::vector<std::pair<int, InterMissionClosure>> late;
  for (const int k : closures_of_pair) {
    const LoopCandidate& candidate = closures[k].candidate;
    const InterMissionClosure closure =
        From(candidate, /*reversed=*/PositionOf(candidate.from) != pair.first);
    if (consistency_row[k] >= 0) {
      rows[consistency_row[k]] = closure;
    } else if (consistency_row[k] == kNoRow && set.Size() < kMaxRows) {
      // What AddCandidate lets in, this takes; if not, the closure stays outside the set.
      if (!set.Add(closure, a, b).ok()) continue;
      consistency_row[k] = set.Size() - 1;
      rows.push_back(closure);
    } else if (consistency_row[k] == kNoRow) {
      late.emplace_back(k, closure);
    }
  }
  const std::vector<int>& members = set.ConsistentSet().members;
  for (const auto& [k, closure] : late) {
    consistency_row[k] =
        AgreesWithMost(closure, rows, members, a, b) ? kAgreesWithSet : kDisagreesWithSet;
  }
  bool lost = false;
  for (const int k : closures_of_pair) {
    ClosureRecord& record = closures[k];
    record.consistent_set = static_cast<int>(members.size());
    const bool consistent =
        consistency_row[k] == kAgreesWithSet ||
        (consistency_row[k] >= 0 &&
         std::binary_search(members.begin(), members.end(), consistency_row[k]));
    if (consistent && record.verdict == ClosureVerdict::kRejectedInconsistent) {
      regained.push_back(k);
    } else if (!consistent && record.verdict != ClosureVerdict::kRejectedInconsistent) {
      lost |= record.verdict == ClosureVerdict::kAccepted;
      SetVerdict(record, ClosureVerdict::kRejectedInconsistent);
      record.weight = 0;
    }
  }
  return lost;
}

// Against the map as it stands, once the frames are joined.
void MultiRobotMap::State::JudgeWeakClosures() {
  for (int k = 0; k < static_cast<int>(closures.size()); ++k) {
    ClosureRecord& record = closures[k];
    const bool judged = InPlay(k) || record.verdict == ClosureVerdict::kRejectedDegenerate;
    const LoopCandidate& candidate = record.candidate;
    if (!judged || !IsWeak(candidate) || record.verdict == ClosureVerdict::kForcedByOperator)
      continue;
    if (JudgeFigures(candidate) != ClosureVerdict::kPending) continue;
    if (FrameOf(candidate.from) != FrameOf(candidate.to)) continue;  // for the quarantine
    const Rigid3d expected = PoseOf(candidate.from)->Inverse() * *PoseOf(candidate.to);
    const Rigid3d error = expected.Inverse() * candidate.from_tform_to;
    const bool plausible = error.translation.norm() <= kMaxWeakErrorM &&
                           LogSO3(error.rotation).norm() <= kMaxWeakErrorRad;
    if (plausible && record.verdict == ClosureVerdict::kRejectedDegenerate) {
      SetVerdict(record, ClosureVerdict::kAccepted);
      record.weight = 1;
    } else if (!plausible) {
      SetVerdict(record, ClosureVerdict::kRejectedDegenerate);
      record.weight = 0;
    }
  }
}

}  // namespace overtone
