// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/knot_parts.h"

#include <algorithm>
#include <utility>

namespace overtone {

KnotParts::KnotParts(const ChordPrediction& prediction, std::vector<int> knots, int max_samples)
    : prediction_(prediction), max_samples_(max_samples), knots_(std::move(knots)) {
  for (int k = 0; k < knots_.size(); ++k) parts_.push_back(Part(Before(k), knots_[k]));
  parts_.push_back(Part(knots_.back(), prediction_.size()));
  for (const ResidualSums& part : parts_) whole_ += part;
  rmse_m_ = prediction_.Rmse(whole_);
}

ResidualSums KnotParts::Part(int from, int to) const {
  if (from < 0) return prediction_.Before(to, max_samples_);
  if (to == prediction_.size()) return prediction_.Behind(from, max_samples_);
  return prediction_.Between(from, to, max_samples_);
}

bool KnotParts::Move(int k, int row) {
  constexpr double kSmallestGain = 1e-4;
  if (row <= Before(k) || row >= Behind(k)) return false;
  const ResidualSums left = Part(Before(k), row), right = Part(row, Behind(k));
  ResidualSums whole = whole_;
  (whole -= parts_[k]) -= parts_[k + 1];
  (whole += left) += right;
  const double rmse_m = prediction_.Rmse(whole);
  if (!(rmse_m < rmse_m_ * (1 - kSmallestGain))) return false;
  knots_[k] = row;
  parts_[k] = left;
  parts_[k + 1] = right;
  whole_ = whole;
  rmse_m_ = rmse_m;
  return true;
}

int KnotParts::LargestStep(int k) const {
  const int first = std::max(Before(k), 0);
  const int last = std::min(Behind(k), prediction_.size() - 1);
  return std::max(knots_[k] - first, last - knots_[k]) / 2;
}

double KnotParts::RmseWith(int row) const {
  const int k =
      static_cast<int>(std::lower_bound(knots_.begin(), knots_.end(), row) - knots_.begin());
  ResidualSums whole = whole_;
  whole -= parts_[k];
  const int behind = k == knots_.size() ? prediction_.size() : knots_[k];
  (whole += Part(Before(k), row)) += Part(row, behind);
  return prediction_.Rmse(whole);
}

void KnotParts::Remove(int k) {
  const ResidualSums joined = Part(Before(k), Behind(k));
  ((whole_ -= parts_[k]) -= parts_[k + 1]) += joined;
  parts_[k] = joined;
  parts_.erase(parts_.begin() + k + 1);
  knots_.erase(knots_.begin() + k);
  rmse_m_ = prediction_.Rmse(whole_);
}

}  // namespace overtone
