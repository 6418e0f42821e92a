// SPDX-License-Identifier: Apache-2.0
// The optimal partition of a mission by dynamic programming over candidate knots. What a stretch
// between two knots costs does not depend on the others, but for the rigid motion that aligns the
// whole; with that motion given, the sum of squares decomposes and the optimum is exact:
//     sum |r_i - J_i alignment|^2 = sum over stretches (squares - 2 moment . alignment) + constant.
// Bellman, "On the approximation of curves by line segments using dynamic programming", CACM 4(6),
// 1961.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_KNOT_TABLE_H_
#define OVERTONE_CORE_SYNCHRONIZATION_KNOT_TABLE_H_

#include <vector>

#include "overtone/core/synchronization/chord_prediction.h"

namespace overtone {

class KnotTable {
 public:
  // candidates: rows, strictly increasing, at least two. At most `max_samples` nodes of each
  // stretch are looked at; 0: all. Stretches over more than 20 candidates begin and end at every
  // second one. O(candidates^2 max_samples).
  KnotTable(const ChordPrediction& prediction, std::vector<int> candidates, int max_samples);

  const std::vector<int>& candidates() const { return candidates_; }

  // The two ends of the best single chord, with the alignment that comes of each: all are tried.
  std::vector<int> BestChord(const ChordPrediction& prediction) const;

  // The best knots for every number of chords from 1 to min(max_chords, candidates - 1), at [chords
  // - 1], all of them in one pass. O(candidates^2 max_chords).
  std::vector<std::vector<int>> Best(int max_chords, const Vector6d& alignment) const;

 private:
  int size() const { return static_cast<int>(candidates_.size()); }

  std::vector<int> candidates_;
  std::vector<ResidualSums> before_, behind_;       // of each candidate
  std::vector<std::vector<ResidualSums>> between_;  // [to][from], from < to
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_KNOT_TABLE_H_
