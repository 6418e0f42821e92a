// SPDX-License-Identifier: Apache-2.0
// Knots whose sums are kept stretch by stretch, so that what becomes of a change is known from the
// two or three stretches that it touches, however many knots there are.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_KNOT_PARTS_H_
#define OVERTONE_CORE_SYNCHRONIZATION_KNOT_PARTS_H_

#include <vector>

#include "overtone/core/synchronization/chord_prediction.h"

namespace overtone {

class KnotParts {
 public:
  // `prediction` must outlive it. knots: rows, increasing, at least one. At most `max_samples`
  // nodes of each stretch are looked at; 0: all. O(knots max_samples); every change and every
  // question below is O(max_samples).
  KnotParts(const ChordPrediction& prediction, std::vector<int> knots, int max_samples);

  const std::vector<int>& knots() const { return knots_; }
  const ResidualSums& sums() const { return whole_; }
  double rmse_m() const { return rmse_m_; }

  // Moves knot k to another row between its neighbours. True when the predicted RMSE falls by it;
  // else nothing is changed.
  bool Move(int k, int row);
  // Half of the longer way to a neighbour.
  int LargestStep(int k) const;

  // With one more knot at `row`, which holds none.
  double RmseWith(int row) const;
  // One of at least two goes.
  void Remove(int k);

 private:
  // From one knot to the next; -1: before the first, size(): behind the last.
  ResidualSums Part(int from, int to) const;
  int Before(int k) const { return k == 0 ? -1 : knots_[k - 1]; }
  int Behind(int k) const { return k + 1 == knots_.size() ? prediction_.size() : knots_[k + 1]; }

  const ChordPrediction& prediction_;
  const int max_samples_;
  std::vector<int> knots_;
  std::vector<ResidualSums> parts_;  // parts_[k] ends at knot k
  ResidualSums whole_;
  double rmse_m_ = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_KNOT_PARTS_H_
