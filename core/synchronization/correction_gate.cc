// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/correction_gate.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "overtone/core/synchronization/aligned_rmse.h"
#include "overtone/core/synchronization/knot_selection.h"

namespace overtone {
namespace {

constexpr double kSmallestShare = 0.1;  // of how far the host is, for a gain to be one
constexpr int kMissesToRefute = 2;

int RowOf(const TrajectoryComparison& comparison, int64_t index) {
  const auto& held = comparison.keyframe_index;
  const auto row = std::lower_bound(held.begin(), held.end(), index);
  if (row == held.end() || *row != index) return -1;
  return static_cast<int>(row - held.begin());
}

double RmseBefore(const TrajectoryComparison& comparison, const HostPrediction& prediction) {
  return AlignedRmse(prediction.Of(comparison.onboard), prediction.Of(comparison.server));
}

// The largest motion of a pose, seen from the first, which stays.
std::pair<double, double> LargestCorrection(const std::vector<Rigid3d>& before,
                                            const std::vector<Rigid3d>& after) {
  const Rigid3d after_from_before = after[0] * before[0].Inverse();
  std::pair<double, double> largest = {0, 0};
  for (int i = 1; i < before.size(); ++i) {
    const Rigid3d expected = after_from_before * before[i];
    largest.first = std::max(largest.first, (after[i].translation - expected.translation).norm());
    largest.second =
        std::max(largest.second, LogSO3(expected.rotation.conjugate() * after[i].rotation).norm());
  }
  return largest;
}

}  // namespace

std::string CorrectionGate::JudgeOdometry(const TrajectoryComparison& comparison,
                                          const SelectionContext& context,
                                          const ConstraintBatch& batch) {
  const ChordPrediction prediction = PredictionFor(comparison, options_, context);
  double worst = 0;
  std::string worst_id;
  for (const std::vector<Constraint>* constraints : {&batch.add, &batch.update}) {
    for (const Constraint& constraint : *constraints) {
      const int from = RowOf(comparison, constraint.from), to = RowOf(comparison, constraint.to);
      if (from < 0 || to < 0 || from == to) continue;
      const double chi_square = prediction.GapChiSquare(std::min(from, to), std::max(from, to));
      if (chi_square > worst) std::tie(worst, worst_id) = std::tie(chi_square, constraint.id);
    }
  }
  if (worst <= options_.gate.odometry_chi_square_limit) {
    suspicious_revisions_ = 0;
    return "";
  }
  if (comparison.revision != last_suspicious_) ++suspicious_revisions_;
  last_suspicious_ = comparison.revision;
  if (suspicious_revisions_ >= options_.gate.revisions_to_believe) return "";
  return absl::StrFormat("%s contradicts odometry (chi square %.0f, limit %.0f), revision %d of %d",
                         worst_id, worst, options_.gate.odometry_chi_square_limit,
                         suspicious_revisions_, options_.gate.revisions_to_believe);
}

bool CorrectionGate::Gains(const TrajectoryComparison& comparison,
                           const HostPrediction& prediction) const {
  const double before_m = RmseBefore(comparison, prediction);
  const double needed_m = std::min(options_.gate.min_gain_m, kSmallestShare * before_m);
  return before_m - prediction.rmse_m > needed_m;
}

std::string CorrectionGate::Judge(const TrajectoryComparison& comparison,
                                  const SelectionContext& context, const ConstraintBatch& batch,
                                  const HostPrediction& prediction) {
  if (!options_.gate.enabled || (batch.add.empty() && batch.update.empty())) return "";
  if (comparisons_to_wait_ > 0) {
    return absl::StrCat("an earlier batch did not do what was predicted; ", comparisons_to_wait_--,
                        " comparisons to wait");
  }
  if (!Gains(comparison, prediction)) {
    return absl::StrFormat("no gain: predicted %.3f m from the server's estimate, now %.3f m",
                           prediction.rmse_m, RmseBefore(comparison, prediction));
  }
  const auto [move_m, turn_rad] =
      LargestCorrection(prediction.Of(comparison.onboard), prediction.poses);
  if (move_m > options_.gate.max_correction_m || turn_rad > options_.gate.max_correction_rad) {
    return absl::StrFormat("a correction of %.2f m, %.3f rad, at most %.2f m, %.3f rad", move_m,
                           turn_rad, options_.gate.max_correction_m,
                           options_.gate.max_correction_rad);
  }
  return JudgeOdometry(comparison, context, batch);
}

void CorrectionGate::Applied(const TrajectoryComparison& comparison, const ConstraintBatch& batch,
                             const HostPrediction& prediction) {
  promise_ = Promise();
  for (int i = 0; i < comparison.keyframe_index.size(); ++i) {
    promise_.server[comparison.keyframe_index[i]] = comparison.server[i];
  }
  for (const Constraint& constraint : batch.add) promise_.ids.push_back(constraint.id);
  for (const Constraint& constraint : batch.update) promise_.ids.push_back(constraint.id);
  promise_.rmse_before_m = AlignedRmse(comparison.onboard, comparison.server);
  promise_.predicted_rmse_m = prediction.rmse_m;
  promise_.open = options_.gate.enabled && !promise_.ids.empty();
}

std::vector<std::string> CorrectionGate::Refuted(const TrajectoryComparison& comparison) {
  if (!promise_.open) return {};
  std::vector<Rigid3d> onboard, server;
  for (int i = 0; i < comparison.keyframe_index.size(); ++i) {
    const auto then = promise_.server.find(comparison.keyframe_index[i]);
    if (then == promise_.server.end()) continue;
    onboard.push_back(comparison.onboard[i]);
    server.push_back(then->second);
  }
  const double half_m = 0.5 * (promise_.rmse_before_m + promise_.predicted_rmse_m);
  if (AlignedRmse(onboard, server) <= half_m) {
    promise_ = Promise();
    failures_ = 0;
    return {};
  }
  if (++promise_.misses < kMissesToRefute) return {};
  const std::vector<std::string> ids = std::move(promise_.ids);
  promise_ = Promise();
  comparisons_to_wait_ = ++failures_;
  return ids;
}

}  // namespace overtone
