// SPDX-License-Identifier: Apache-2.0
// Proposes loops between places whose scan contexts are alike.
#ifndef OVERTONE_CORE_PLACE_RECOGNITION_SCAN_CONTEXT_PROPOSER_H_
#define OVERTONE_CORE_PLACE_RECOGNITION_SCAN_CONTEXT_PROPOSER_H_

#include <map>
#include <vector>

#include "absl/status/status.h"
#include "overtone/core/place_recognition/loop_detection.h"
#include "overtone/core/place_recognition/scan_context_index.h"

namespace overtone {

struct ScanContextProposerOptions {
  ScanContextOptions context;
  // From this similarity on a match is worth a closer look. On real data (public_places_test,
  // gathered) 0.6 keeps nine in ten of the revisits found without any, at 3 to 4 proposals a query
  // of the best 5; 0.7 halves the proposals and loses a third of the revisits.
  double min_similarity = 0.6;
  // Of each view, to be measured.
  int max_candidates = 3;
  // Two places of one mission are different ones when the way between them is longer.
  double min_separation_m = 2;
  // The mission's own way back to a place must be at least so long to count as a loop. Longer than
  // the way whose clouds are gathered into a view (cloud_gathering.h): two views that share a
  // keyframe are alike for that alone.
  double min_loop_length_m = 10;
  // That are compared in full.
  int max_comparisons = 50;

  absl::Status Validate() const;
};

// Search among N places visits O(log N) ring keys and compares max_comparisons contexts.
class ScanContextProposer final : public LoopProposer {
 public:
  // `options` must be valid.
  explicit ScanContextProposer(const ScanContextProposerOptions& options)
      : options_(options), index_(options.context, options.max_comparisons) {}

  std::vector<LoopCandidate> Propose(const PlaceView& view) override;
  void Keep(const PlaceView& view) override;
  std::optional<LoopCandidate> MostSimilar(const NodeId& node) const override;

 private:
  struct Place {
    NodeId node;
    double travelled_m = 0;
    Eigen::Quaterniond level_from_body;
  };

  Place PlaceOf(const PlaceView& view) const;
  void Add(const Place& place, ScanContext context);
  bool MayMatch(const Place& query, const Place& place) const;
  LoopCandidate Candidate(const Place& query, const PlaceMatch& match) const;

  const ScanContextProposerOptions options_;
  ScanContextIndex index_;
  std::vector<Place> places_;  // by the index's numbers
  std::map<NodeId, int> place_of_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_PLACE_RECOGNITION_SCAN_CONTEXT_PROPOSER_H_
