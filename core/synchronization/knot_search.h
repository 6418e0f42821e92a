// SPDX-License-Identifier: Apache-2.0
// Where to put a given number of knots, or as few as do, such that the predicted RMSE is least.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_KNOT_SEARCH_H_
#define OVERTONE_CORE_SYNCHRONIZATION_KNOT_SEARCH_H_

#include <map>
#include <optional>
#include <vector>

#include "overtone/core/synchronization/chord_prediction.h"
#include "overtone/core/synchronization/knot_parts.h"
#include "overtone/core/synchronization/knot_table.h"

namespace overtone {

// Rows, increasing; chords join consecutive ones. No knots: odometry as it is.
struct KnotSet {
  std::vector<int> knots;
  double rmse_m = 0;  // ChordPrediction::ExactRmse

  int NumChords() const { return knots.empty() ? 0 : static_cast<int>(knots.size()) - 1; }
};

struct KnotSearchOptions {
  int max_candidates = 96;         // of the dynamic programme; its table has half their square
  int samples_per_stretch = 12;    // nodes that stand for a stretch in the table, ...
  int samples_to_compare = 16;     // ... when knots are moved, ...
  int samples_in_refinement = 48;  // ... and when the best are, at last; 0: all
  // With so few chords, where the alignment matters most, single knots are tried everywhere.
  int max_chords_to_try_all = 4;
};

// Not thread-safe: it remembers what it has found.
class KnotSearch {
 public:
  // `prediction` must outlive it and have at least two nodes.
  // O(nodes); the table, O(candidates^2 samples_per_stretch), comes with the first call for it.
  KnotSearch(const ChordPrediction& prediction, const KnotSearchOptions& options);

  // The best that is found for exactly so many chords, or for as many as there are candidates for:
  // from the dynamic programme's answer and from each of `starts` (those of another number are
  // passed over), knots are moved between their neighbours, and the programme is asked again with
  // the alignment that has come of it. So it is never worse by its own prediction than a start.
  // Single knots are moved by few samples as long as answers are compared, and by more at last;
  // what is returned has been predicted exactly. O(nodes + num_chords (candidates^2 +
  // samples_in_refinement log nodes)), a few times over.
  KnotSet BestOf(int num_chords, const std::vector<std::vector<int>>& starts) const;

  // The best of `knots` and what comes of them by moving single ones, by taking the one that is
  // missed least to where it helps most, and both: as many, at least two. Without a table:
  // O(nodes + candidates samples_per_stretch), and Refine twice.
  KnotSet Improved(const std::vector<int>& knots) const;

  // Without the knot whose going raises the predicted RMSE least; at least two.
  std::vector<int> OneFewer(const std::vector<int>& knots) const;

  // What the programme alone comes to for 1, 2 ... max_chords chords (or as many as there are
  // candidates for), as far as samples show: predicted RMSE in metres. O(max_chords candidates^2).
  std::vector<double> Estimates(int max_chords) const;

  // Moves single knots as long as that lowers the predicted RMSE. O(max_samples) for each place
  // that is tried: O(knots log nodes) of them, a few times over.
  std::vector<int> Refine(const std::vector<int>& knots, int max_samples) const;

 private:
  const KnotTable& Table() const;
  const KnotSet& BestOf(int num_chords) const;
  KnotSet Better(const KnotSet& best, const std::vector<int>& start) const;
  KnotSet Reinserted(KnotSet set) const;
  KnotSet Polished(const KnotSet& set) const;
  KnotSet Alternate(std::vector<int> knots) const;
  void OneMore(const KnotParts& knots, std::vector<int>* best, double* best_rmse_m) const;
  KnotParts WithoutLeastMissed(const KnotParts& knots) const;
  std::vector<int> Reinsert(const std::vector<int>& knots) const;

  const ChordPrediction& prediction_;
  const KnotSearchOptions options_;
  const std::vector<int> candidates_;
  mutable std::optional<KnotTable> table_;               // once it is asked
  mutable std::map<int, std::optional<KnotSet>> known_;  // by the number of chords, without starts
};

// Rows of `count` candidates for knots: equal shares of the nodes, and both ends of the largest
// steps in which server and odometry disagree. Strictly increasing; all rows where there are fewer.
std::vector<int> CandidateKnots(const ChordPrediction& prediction, int count);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_KNOT_SEARCH_H_
