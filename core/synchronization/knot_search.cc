// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/knot_search.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <tuple>
#include <utility>

namespace overtone {
namespace {

// Knots whose sums are kept stretch by stretch, so that moving one costs two stretches.
class MovingKnots {
 public:
  MovingKnots(const ChordPrediction& prediction, const std::vector<int>& knots, int max_samples)
      : prediction_(prediction), max_samples_(max_samples), knots_(knots) {
    for (int gap = 0; gap <= knots_.size(); ++gap) {
      parts_.push_back(Part(gap));
      whole_ += parts_.back();
    }
    rmse_ = prediction_.Rmse(whole_);
  }

  // True when the prediction gets better by it; else nothing is changed.
  bool Move(int k, int row) {
    const int low = k == 0 ? -1 : knots_[k - 1];
    const int high = k + 1 == knots_.size() ? prediction_.size() : knots_[k + 1];
    if (row <= low || row >= high) return false;
    const int before = std::exchange(knots_[k], row);
    const ResidualSums left = Part(k), right = Part(k + 1);
    ResidualSums whole = whole_;
    (whole -= parts_[k]) -= parts_[k + 1];
    (whole += left) += right;
    const double rmse = prediction_.Rmse(whole);
    if (!(rmse < rmse_ * (1 - kSmallestGain))) {
      knots_[k] = before;
      return false;
    }
    parts_[k] = left;
    parts_[k + 1] = right;
    whole_ = whole;
    rmse_ = rmse;
    return true;
  }

  // Half of the longer way to a neighbour.
  int LargestStep(int k) const {
    const int low = k == 0 ? 0 : knots_[k - 1];
    const int high = k + 1 == knots_.size() ? prediction_.size() - 1 : knots_[k + 1];
    return std::max(knots_[k] - low, high - knots_[k]) / 2;
  }

  const std::vector<int>& knots() const { return knots_; }

 private:
  static constexpr double kSmallestGain = 1e-4;

  // Before the first knot, between two, behind the last.
  ResidualSums Part(int gap) const {
    if (gap == 0) return prediction_.Before(knots_.front(), max_samples_);
    if (gap == knots_.size()) return prediction_.Behind(knots_.back(), max_samples_);
    return prediction_.Between(knots_[gap - 1], knots_[gap], max_samples_);
  }

  const ChordPrediction& prediction_;
  const int max_samples_;
  std::vector<int> knots_;
  std::vector<ResidualSums> parts_;
  ResidualSums whole_;
  double rmse_ = 0;
};

// A short mission's table is small: more of each stretch can be looked at for the same work.
KnotSearchOptions Adapted(KnotSearchOptions options, int num_nodes) {
  const int most = options.max_candidates;
  const int fewer = std::min(num_nodes, most);
  if (options.samples_per_stretch > 0 && fewer > 0) {
    options.samples_per_stretch =
        static_cast<int>(static_cast<int64_t>(options.samples_per_stretch) * most * most /
                         (static_cast<int64_t>(fewer) * fewer));
  }
  return options;
}

}  // namespace

std::vector<int> CandidateKnots(const ChordPrediction& prediction, int count) {
  const int n = prediction.size();
  count = std::clamp(count, 2, n);
  const int jumps = std::min(count / 12, n - 1);
  std::vector<std::pair<double, int>> steps;
  for (int i = 1; i < n; ++i) steps.emplace_back(prediction.GapChiSquare(i - 1, i), i);
  std::partial_sort(steps.begin(), steps.begin() + jumps, steps.end(), std::greater<>());
  std::vector<int> candidates;
  for (int k = 0; k < jumps; ++k) {
    candidates.insert(candidates.end(), {steps[k].second - 1, steps[k].second});
  }
  const int shares = count == n ? n : std::max(count - 2 * jumps, 2);
  for (int k = 0; k < shares; ++k) {
    candidates.push_back(static_cast<int>(static_cast<int64_t>(k) * (n - 1) / (shares - 1)));
  }
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  return candidates;
}

KnotSearch::KnotSearch(const ChordPrediction& prediction, const KnotSearchOptions& options)
    : prediction_(prediction),
      options_(Adapted(options, prediction.size())),
      table_(prediction, CandidateKnots(prediction, options_.max_candidates),
             options_.samples_per_stretch) {}

std::vector<int> KnotSearch::Refine(const std::vector<int>& knots) const {
  constexpr int kMaxPasses = 4;
  MovingKnots moving(prediction_, knots, options_.samples_in_refinement);
  bool moved = true;
  for (int pass = 0; moved && pass < kMaxPasses; ++pass) {
    moved = false;
    for (int k = 0; k < knots.size(); ++k) {
      for (int step = moving.LargestStep(k); step > 0; step /= 2) {
        const int row = moving.knots()[k];
        if (moving.Move(k, row - step) || moving.Move(k, row + step)) moved = true;
      }
    }
  }
  return moving.knots();
}

KnotSet KnotSearch::Better(const KnotSet& best, const std::vector<int>& knots) const {
  const double rmse_m = prediction_.ExactRmse(knots);
  return best.knots.empty() || rmse_m < best.rmse_m ? KnotSet{knots, rmse_m} : best;
}

// The table knows the optimum for a given alignment, refining the best alignment for given knots.
KnotSet KnotSearch::Alternate(std::vector<int> knots) const {
  constexpr int kMaxRounds = 6;
  KnotSet best = Better(KnotSet(), knots);
  for (int round = 0; round < kMaxRounds; ++round) {
    knots = Refine(knots);
    const KnotSet refined = Better(best, knots);
    if (round > 0 && !(refined.rmse_m < best.rmse_m)) break;
    best = refined;
    const ResidualSums sums = prediction_.Of(knots, options_.samples_in_refinement);
    knots = table_.Best(best.NumChords(), prediction_.Alignment(sums)).back();
    if (knots.size() != best.knots.size()) break;  // fewer candidates than that
    best = Better(best, knots);
  }
  return best;
}

// One knot goes, and comes back where it lowers the predicted RMSE most.
std::vector<int> KnotSearch::Reinsert(const std::vector<int>& knots) const {
  std::vector<int> best = knots;
  double best_rmse_m = prediction_.Rmse(prediction_.Of(knots, options_.samples_per_stretch));
  for (const int gone : knots) {
    for (const int row : table_.candidates()) {
      std::vector<int> changed = knots;
      *std::find(changed.begin(), changed.end(), gone) = row;
      std::sort(changed.begin(), changed.end());
      if (std::adjacent_find(changed.begin(), changed.end()) != changed.end()) continue;
      const double rmse_m = prediction_.Rmse(prediction_.Of(changed, options_.samples_per_stretch));
      if (rmse_m < best_rmse_m) std::tie(best, best_rmse_m) = std::pair(changed, rmse_m);
    }
  }
  return best;
}

// The best of one chord fewer, and one knot more where it lowers the predicted RMSE most.
std::vector<int> KnotSearch::OneMore(const std::vector<int>& knots) const {
  std::vector<int> best;
  double best_rmse_m = 0;
  for (const int row : table_.candidates()) {
    std::vector<int> more = knots;
    const auto place = std::lower_bound(more.begin(), more.end(), row);
    if (place != more.end() && *place == row) continue;
    more.insert(place, row);
    const double rmse_m = prediction_.Rmse(prediction_.Of(more, options_.samples_per_stretch));
    if (best.empty() || rmse_m < best_rmse_m) std::tie(best, best_rmse_m) = std::pair(more, rmse_m);
  }
  return best;
}

KnotSet KnotSearch::BestOf(int num_chords, const std::vector<std::vector<int>>& starts) const {
  KnotSet best = Alternate(table_.Best(num_chords, Vector6d::Zero()).back());
  const auto try_from = [&](const std::vector<int>& knots) {
    if (knots.size() != num_chords + 1) return false;
    const KnotSet other = Alternate(knots);
    const bool better = other.rmse_m < best.rmse_m;
    if (better) best = other;
    return better;
  };
  for (const std::vector<int>& start : starts) try_from(start);
  if (num_chords > options_.max_chords_to_try_all) return best;
  try_from(num_chords == 1 ? table_.BestChord(prediction_)
                           : OneMore(BestOf(num_chords - 1, {}).knots));
  while (try_from(Reinsert(best.knots))) continue;
  return best;
}

}  // namespace overtone
