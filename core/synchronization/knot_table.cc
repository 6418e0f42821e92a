// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/knot_table.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

namespace overtone {
namespace {

// A long stretch is much like one whose ends are a candidate off: only every second one of each end
// is looked at.
bool IsPossible(int from, int to) {
  constexpr int kLong = 20;  // candidates
  return to - from <= kLong || (from % 2 == 0 && to % 2 == 0);
}

ResidualSums Impossible() {
  ResidualSums sums;
  sums.squares = std::numeric_limits<double>::infinity();
  return sums;
}

double Cost(const ResidualSums& sums, const Vector6d& alignment) {
  return sums.squares - 2 * sums.moment.dot(alignment);
}

// The cheapest way to put the last knot of so many chords on each candidate.
struct Layer {
  std::vector<double> cost;
  std::vector<int> previous;  // candidate of the knot before, -1: there is none
};

}  // namespace

KnotTable::KnotTable(const ChordPrediction& prediction, std::vector<int> candidates,
                     int max_samples)
    : candidates_(std::move(candidates)), between_(candidates_.size()) {
  for (int to = 0; to < size(); ++to) {
    before_.push_back(prediction.Before(candidates_[to], max_samples));
    behind_.push_back(prediction.Behind(candidates_[to], max_samples));
    between_[to].reserve(to);
    for (int from = 0; from < to; ++from) {
      between_[to].push_back(
          IsPossible(from, to) ? prediction.Between(candidates_[from], candidates_[to], max_samples)
                               : Impossible());
    }
  }
}

std::vector<int> KnotTable::BestChord(const ChordPrediction& prediction) const {
  std::vector<int> best;
  double best_rmse_m = 0;
  for (int to = 1; to < size(); ++to) {
    for (int from = 0; from < to; ++from) {
      ResidualSums sums = before_[from];
      (sums += between_[to][from]) += behind_[to];
      const double rmse_m = prediction.Rmse(sums);
      if (!best.empty() && rmse_m >= best_rmse_m) continue;
      best = {candidates_[from], candidates_[to]};
      best_rmse_m = rmse_m;
    }
  }
  return best;
}

std::vector<std::vector<int>> KnotTable::Best(int max_chords, const Vector6d& alignment) const {
  max_chords = std::min(max_chords, size() - 1);
  std::vector<std::vector<double>> stretch(size());
  std::vector<Layer> layers(1);
  for (int to = 0; to < size(); ++to) {
    for (const ResidualSums& sums : between_[to]) stretch[to].push_back(Cost(sums, alignment));
    layers[0].cost.push_back(Cost(before_[to], alignment));
    layers[0].previous.push_back(-1);
  }
  std::vector<std::vector<int>> best;
  for (int chords = 1; chords <= max_chords; ++chords) {
    Layer layer = layers.back();
    double lowest = 0;
    int end = -1;
    for (int to = chords; to < size(); ++to) {
      int previous = -1;
      double cost = 0;
      for (int from = chords - 1; from < to; ++from) {
        const double through = layers.back().cost[from] + stretch[to][from];
        if (previous < 0 || through < cost) std::tie(previous, cost) = std::pair(from, through);
      }
      layer.cost[to] = cost;
      layer.previous[to] = previous;
      const double whole = cost + Cost(behind_[to], alignment);
      if (end < 0 || whole < lowest) std::tie(end, lowest) = std::pair(to, whole);
    }
    layers.push_back(std::move(layer));
    std::vector<int> knots;
    for (int k = chords; k >= 0; --k) {
      knots.push_back(candidates_[end]);
      end = layers[k].previous[end];
    }
    best.emplace_back(knots.rbegin(), knots.rend());
  }
  return best;
}

}  // namespace overtone
