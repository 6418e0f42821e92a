// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/knot_search.h"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>

#include "overtone/core/synchronization/knot_parts.h"

namespace overtone {
namespace {

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
      candidates_(CandidateKnots(prediction, options_.max_candidates)) {}

const KnotTable& KnotSearch::Table() const {
  if (!table_.has_value()) table_.emplace(prediction_, candidates_, options_.samples_per_stretch);
  return *table_;
}

std::vector<int> KnotSearch::Refine(const std::vector<int>& knots, int max_samples) const {
  constexpr int kMaxPasses = 4;
  KnotParts parts(prediction_, knots, max_samples);
  bool moved = true;
  for (int pass = 0; moved && pass < kMaxPasses; ++pass) {
    moved = false;
    for (int k = 0; k < knots.size(); ++k) {
      for (int step = parts.LargestStep(k); step > 0; step /= 2) {
        const int row = parts.knots()[k];
        if (parts.Move(k, row - step) || parts.Move(k, row + step)) moved = true;
      }
    }
  }
  return parts.knots();
}

// The table knows the optimum for a given alignment, refining the best alignment for given knots.
KnotSet KnotSearch::Alternate(std::vector<int> knots) const {
  constexpr int kMaxRounds = 6;
  constexpr double kSmallestGain = 1e-3;
  KnotSet best = {knots, prediction_.ExactRmse(knots)};
  for (int round = 0; round < kMaxRounds; ++round) {
    knots = Refine(knots, options_.samples_to_compare);
    const double rmse_m = prediction_.ExactRmse(knots);
    const bool enough = round > 0 && !(rmse_m < best.rmse_m * (1 - kSmallestGain));
    if (rmse_m < best.rmse_m) best = {knots, rmse_m};
    if (enough) break;
    const ResidualSums sums = prediction_.Of(best.knots, options_.samples_to_compare);
    knots = Table().Best(best.NumChords(), prediction_.Alignment(sums)).back();
    if (knots.size() != best.knots.size()) break;  // fewer candidates than that
  }
  return best;
}

// The best of `knots` and one more of the candidates.
void KnotSearch::OneMore(const KnotParts& knots, std::vector<int>* best,
                         double* best_rmse_m) const {
  int best_row = -1;
  for (const int row : candidates_) {
    if (std::binary_search(knots.knots().begin(), knots.knots().end(), row)) continue;
    const double rmse_m = knots.RmseWith(row);
    if (!(rmse_m < *best_rmse_m)) continue;
    *best_rmse_m = rmse_m;
    best_row = row;
  }
  if (best_row < 0) return;
  *best = knots.knots();
  best->insert(std::lower_bound(best->begin(), best->end(), best_row), best_row);
}

KnotParts KnotSearch::WithoutLeastMissed(const KnotParts& knots) const {
  std::optional<KnotParts> best;
  for (int gone = 0; gone < knots.knots().size(); ++gone) {
    KnotParts fewer = knots;
    fewer.Remove(gone);
    if (!best.has_value() || fewer.rmse_m() < best->rmse_m()) best.emplace(std::move(fewer));
  }
  return *std::move(best);
}

std::vector<int> KnotSearch::OneFewer(const std::vector<int>& knots) const {
  return WithoutLeastMissed(KnotParts(prediction_, knots, options_.samples_per_stretch)).knots();
}

// One knot goes, and comes back where it lowers the predicted RMSE most: with few chords each of
// them in turn, else the one that is missed least.
std::vector<int> KnotSearch::Reinsert(const std::vector<int>& knots) const {
  const KnotParts parts(prediction_, knots, options_.samples_per_stretch);
  std::vector<int> best = knots;
  double best_rmse_m = parts.rmse_m();
  if (knots.size() > options_.max_chords_to_try_all + 1) {
    OneMore(WithoutLeastMissed(parts), &best, &best_rmse_m);
    return best;
  }
  for (int gone = 0; gone < knots.size(); ++gone) {
    KnotParts fewer = parts;
    fewer.Remove(gone);
    OneMore(fewer, &best, &best_rmse_m);
  }
  return best;
}

KnotSet KnotSearch::BestOf(int num_chords, const std::vector<std::vector<int>>& starts) const {
  KnotSet best = BestOf(num_chords);
  for (const std::vector<int>& start : starts) {
    if (start.size() == num_chords + 1) best = Better(best, start);
  }
  return Polished(Reinserted(best));
}

// What one refinement leaves far behind is not followed further; a start itself is a candidate.
KnotSet KnotSearch::Better(const KnotSet& best, const std::vector<int>& start) const {
  constexpr double kFarBehind = 1.05;
  if (start == best.knots) return best;
  const double start_rmse_m = prediction_.ExactRmse(start);
  const KnotSet& better = start_rmse_m < best.rmse_m ? KnotSet{start, start_rmse_m} : best;
  const std::vector<int> refined = Refine(start, options_.samples_to_compare);
  if (prediction_.ExactRmse(refined) > kFarBehind * better.rmse_m) return better;
  KnotSet other = Alternate(refined);
  return other.rmse_m < better.rmse_m ? other : better;
}

KnotSet KnotSearch::Reinserted(KnotSet set) const {
  constexpr int kMaxRounds = 4;
  for (int round = 0; round < kMaxRounds; ++round) {
    const double before_m = set.rmse_m;
    set = Better(set, Reinsert(set.knots));
    if (!(set.rmse_m < before_m)) break;
  }
  return set;
}

KnotSet KnotSearch::Improved(const std::vector<int>& knots) const {
  KnotSet best = {knots, prediction_.ExactRmse(knots)};
  const std::vector<int> refined = Refine(knots, options_.samples_to_compare);
  for (const std::vector<int>& changed :
       {refined, Refine(Reinsert(refined), options_.samples_to_compare)}) {
    const double rmse_m = prediction_.ExactRmse(changed);
    if (rmse_m < best.rmse_m) best = {changed, rmse_m};
  }
  return best;
}

KnotSet KnotSearch::Polished(const KnotSet& set) const {
  const std::vector<int> knots = Refine(set.knots, options_.samples_in_refinement);
  const double rmse_m = prediction_.ExactRmse(knots);
  return rmse_m < set.rmse_m ? KnotSet{knots, rmse_m} : set;
}

const KnotSet& KnotSearch::BestOf(int num_chords) const {
  std::optional<KnotSet>& known = known_[num_chords];
  if (known.has_value()) return *known;
  KnotSet best = Alternate(Table().Best(num_chords, Vector6d::Zero()).back());
  if (num_chords <= options_.max_chords_to_try_all) {
    std::vector<int> more;
    if (num_chords == 1) {
      more = Table().BestChord(prediction_);
    } else {
      double rmse_m = std::numeric_limits<double>::infinity();
      OneMore(KnotParts(prediction_, BestOf(num_chords - 1).knots, options_.samples_per_stretch),
              &more, &rmse_m);
    }
    if (more.size() == num_chords + 1) best = Better(best, more);
    best = Reinserted(best);
  }
  return known.emplace(std::move(best));
}

std::vector<double> KnotSearch::Estimates(int max_chords) const {
  std::vector<double> estimates;
  for (const std::vector<int>& knots : Table().Best(max_chords, Vector6d::Zero())) {
    estimates.push_back(prediction_.Rmse(prediction_.Of(knots, options_.samples_per_stretch)));
  }
  return estimates;
}

}  // namespace overtone
