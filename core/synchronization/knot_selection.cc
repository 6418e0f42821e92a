// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/knot_selection.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "overtone/core/synchronization/chord_selection.h"
#include "overtone/core/synchronization/constraint_generation.h"
#include "overtone/core/synchronization/knot_search.h"
#include "overtone/core/synchronization/knot_update.h"

namespace overtone {
namespace {

// Of a chord's variance, at most, in odometry's over the same way.
constexpr double kLargestVarianceShare = 1e-3;
// Knots stay while they are so much worse than the best, as a share of what is left.
constexpr double kToleratedLoss = 0.1;

std::vector<int> UniformKnots(const TrajectoryComparison& comparison,
                              SynchronizationOptions options, int num_chords) {
  options.selection.n = num_chords;
  return KnotRows(comparison, UniformChords(comparison, options));
}

// The fewest chords that come within the tolerance; with more than that the best of max_chords.
// The programme's estimates, as far off as the search has found them to be, say where to look.
KnotSet FewestKnots(const TrajectoryComparison& comparison, const SynchronizationOptions& options,
                    const ChordPrediction& prediction, const KnotSearch& search) {
  const double tolerance_m = options.selection.tolerance_m;
  int fewest = 1, most = std::min(options.selection.n, prediction.size() - 1);
  const std::vector<double> estimates = search.Estimates(most);
  double found_over_estimate = 1;
  KnotSet best;
  bool within = false;
  while (fewest <= most) {
    int chords = fewest;
    // Beyond the candidates there is no estimate, and no better answer than with all of them.
    const auto estimate = [&] { return estimates[std::min<size_t>(chords, estimates.size()) - 1]; };
    while (chords < most && estimate() * found_over_estimate > tolerance_m) ++chords;
    KnotSet found = search.BestOf(chords, {UniformKnots(comparison, options, chords)});
    if (estimate() > 0) found_over_estimate = found.rmse_m / estimate();
    if (found.rmse_m > tolerance_m) {
      fewest = chords + 1;
      if (!within) best = std::move(found);
    } else {
      most = chords - 1;
      best = std::move(found);
      within = true;
    }
  }
  return best;
}

// Whether knots in force are better than none and as many as they should be, and no small change of
// them gains enough.
bool StillServe(const std::vector<int>& known, const SynchronizationOptions& options,
                const ChordPrediction& prediction, double without_m, const KnotSearch& search) {
  const double tolerance_m = options.selection.tolerance_m;
  const int chords = static_cast<int>(known.size()) - 1;
  const int most = std::min(options.selection.n, prediction.size() - 1);
  if (chords < 1 || chords > most) return false;
  const double rmse_m = prediction.ExactRmse(known);
  if (!(rmse_m < without_m) || (rmse_m > tolerance_m && chords < most)) return false;
  const KnotSet improved = search.Improved(known);
  if (rmse_m - improved.rmse_m > kToleratedLoss * std::max(tolerance_m, improved.rmse_m)) {
    return false;
  }
  // With one to spare, fewer may do.
  if (improved.rmse_m > tolerance_m || chords == 1) return true;
  return search.Improved(search.OneFewer(improved.knots)).rmse_m > tolerance_m;
}

Constraint KnotChord(const TrajectoryComparison& comparison, const ChordPrediction& prediction,
                     int from, int to, const SynchronizationOptions& options) {
  const double score = RelativePoseDiscrepancy(comparison, from, to, options.signal_weights);
  Constraint chord =
      ServerConstraint(comparison, from, to, ConstraintKind::kChord, score, options.constraints);
  const Vector6d odometry = prediction.Covariance(from, to).diagonal();
  const Vector6d variance =
      (kLargestVarianceShare * odometry).cwiseMin(chord.covariance.diagonal());
  chord.covariance = variance.asDiagonal();
  return chord;
}

}  // namespace

ChordPrediction PredictionFor(const TrajectoryComparison& comparison,
                              const SynchronizationOptions& options,
                              const SelectionContext& context) {
  const std::vector<Rigid3d>& odometry =
      context.odometry.empty() ? comparison.onboard : context.odometry;
  if (!context.step_covariance.empty()) {
    return ChordPrediction(comparison.server, odometry, context.step_covariance);
  }
  std::vector<Matrix6d> covariance = {Matrix6d::Identity()};
  for (int i = 1; i < odometry.size(); ++i) {
    covariance.push_back(
        OdometryCovariance(odometry[i - 1].Inverse() * odometry[i], options.odometry));
  }
  return ChordPrediction(comparison.server, odometry, covariance);
}

std::vector<int> KnotRows(const TrajectoryComparison& comparison,
                          const std::vector<Constraint>& constraints) {
  std::vector<const Constraint*> chords;
  for (const Constraint& constraint : constraints) {
    if (constraint.kind != ConstraintKind::kChord) return {};
    chords.push_back(&constraint);
  }
  std::sort(chords.begin(), chords.end(),
            [](const Constraint* a, const Constraint* b) { return a->from < b->from; });
  std::vector<int> rows;
  int64_t knot = chords.empty() ? 0 : chords.front()->from;
  const std::vector<int64_t>& held = comparison.keyframe_index;
  for (int k = 0; k <= chords.size() && !chords.empty(); ++k) {
    const auto row = std::lower_bound(held.begin(), held.end(), knot);
    if (row == held.end() || *row != knot) return {};
    rows.push_back(static_cast<int>(row - held.begin()));
    if (k == chords.size()) break;
    if (chords[k]->from != knot || chords[k]->to <= knot) return {};
    knot = chords[k]->to;
  }
  return rows;
}

std::vector<Constraint> SelectKnots(const TrajectoryComparison& comparison,
                                    const SynchronizationOptions& options,
                                    const SelectionContext& context) {
  const ChordPrediction prediction = PredictionFor(comparison, options, context);
  const double tolerance_m = options.selection.tolerance_m;
  const double without_m = prediction.ExactRmse({});
  if (without_m <= tolerance_m) return {};
  const KnotSearch search(prediction, KnotSearchOptions());
  std::vector<int> knots = KnotRows(comparison, context.active);
  if (!StillServe(knots, options, prediction, without_m, search)) {
    const KnotSet best = FewestKnots(comparison, options, prediction, search);
    if (!(best.rmse_m < without_m)) return {};
    const double allowed_m = kToleratedLoss * std::max(tolerance_m, best.rmse_m);
    knots = knots.empty() ? best.knots : UpdateKnots(prediction, knots, best, allowed_m);
  }
  std::vector<Constraint> chords;
  for (int k = 1; k < knots.size(); ++k) {
    chords.push_back(KnotChord(comparison, prediction, knots[k - 1], knots[k], options));
  }
  return chords;
}

}  // namespace overtone
