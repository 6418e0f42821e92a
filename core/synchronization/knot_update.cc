// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/knot_update.h"

#include <algorithm>
#include <iterator>

namespace overtone {
namespace {

constexpr int kSamples = 16;  // of a stretch, to rank changes

using Knots = std::vector<int>;

Knots Difference(const Knots& a, const Knots& b) {
  Knots difference;
  std::set_difference(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(difference));
  return difference;
}

// The best of `changes` by what change(knots, row) makes of the knots.
template <typename Change>
Knots BestChange(const ChordPrediction& prediction, const Knots& knots, const Knots& changes,
                 const Change& change) {
  Knots best;
  double best_rmse_m = 0;
  for (const int row : changes) {
    const Knots changed = change(knots, row);
    const double rmse_m = prediction.Rmse(prediction.Of(changed, kSamples));
    if (best.empty() || rmse_m < best_rmse_m) {
      best = changed;
      best_rmse_m = rmse_m;
    }
  }
  return best;
}

Knots With(Knots knots, int row) {
  knots.insert(std::lower_bound(knots.begin(), knots.end(), row), row);
  return knots;
}

Knots Without(Knots knots, int row) {
  knots.erase(std::lower_bound(knots.begin(), knots.end(), row));
  return knots;
}

}  // namespace

std::vector<int> UpdateKnots(const ChordPrediction& prediction, const std::vector<int>& known,
                             const KnotSet& target, double allowed_loss_m) {
  Knots knots = known;
  while (knots.size() > target.knots.size() ||
         prediction.ExactRmse(knots) - target.rmse_m > allowed_loss_m) {
    const Knots missing = Difference(target.knots, knots);
    const Knots surplus = Difference(knots, target.knots);
    if (missing.empty()) return target.knots;
    if (knots.size() <= target.knots.size()) {
      knots = BestChange(prediction, knots, missing, With);
    }
    if (knots.size() > target.knots.size()) {
      knots = BestChange(prediction, knots, surplus, Without);
    }
  }
  return knots;
}

}  // namespace overtone
