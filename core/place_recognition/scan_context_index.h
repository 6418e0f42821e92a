// SPDX-License-Identifier: Apache-2.0
// The places a map has seen, searched by likeness: a kd-tree over ring keys names a few, and only
// these are compared in full.
//
// With N places: Add is O(log^2 N) on average. Search visits part of the tree and makes at most
// `candidates` comparisons, however large N is. About 8 kB a place at the default options.
//
// One thread may Add while none searches; any number may search at once.
#ifndef OVERTONE_CORE_PLACE_RECOGNITION_SCAN_CONTEXT_INDEX_H_
#define OVERTONE_CORE_PLACE_RECOGNITION_SCAN_CONTEXT_INDEX_H_

#include <functional>
#include <memory>
#include <vector>

#include "overtone/core/place_recognition/scan_context.h"

namespace overtone {

struct PlaceMatch {
  int place = 0;
  double similarity = 0;  // [0, 1]
  double yaw_rad = 0;     // heading of query_R_place
};

class ScanContextIndex {
 public:
  // `candidates`: ring keys of limited sensors do not quite survive a turn, so many are looked at.
  // On real data 50 find what comparing all would, to 0.07 of recall. `options` are valid.
  explicit ScanContextIndex(const ScanContextOptions& options, int candidates = 50);
  ~ScanContextIndex();

  // Returns the place's number: 0, 1, 2, ...
  int Add(ScanContext context);

  // The k most similar of the candidates that `may_match` (number of a place) admits, best first,
  // however little similar: the first is what an explanation names; which are proposed is for the
  // caller's threshold to say. Empty when nothing may match or the query saw nothing.
  std::vector<PlaceMatch> Search(const ScanContext& query, int k,
                                 const std::function<bool(int)>& may_match) const;

  int size() const { return static_cast<int>(places_.size()); }
  const ScanContext& place(int number) const { return places_[number]; }

 private:
  class RingKeys;

  const ScanContextOptions options_;
  const int candidates_;
  std::vector<ScanContext> places_;
  std::unique_ptr<RingKeys> ring_keys_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_PLACE_RECOGNITION_SCAN_CONTEXT_INDEX_H_
