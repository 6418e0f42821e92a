// SPDX-License-Identifier: Apache-2.0
// What each revision changed: for the operator who asks when a map went wrong, and for the way
// back.
#ifndef OVERTONE_CORE_MAPPING_REVISION_HISTORY_H_
#define OVERTONE_CORE_MAPPING_REVISION_HISTORY_H_

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "overtone/core/mapping/map_snapshot.h"

namespace overtone {

struct RevisionRecord {
  uint64_t revision = 0;
  uint64_t map_epoch = 0;
  int missions = 0;
  int anchored_missions = 0;
  int components = 0;
  int64_t keyframes = 0;
  std::map<ClosureVerdict, int64_t> verdicts;
  std::vector<std::string> accepted;  // closures that came into use with it, by id
  std::vector<std::string> dropped;   // that went out of use
  double cost_before = 0;
  double cost_after = 0;
  // Of keyframes that the revision before it held too and whose mission was anchored in both, in
  // metres.
  double mean_move_m = 0;
  double largest_move_m = 0;
  double optimisation_s = 0;
  absl::Time made = absl::InfinitePast();  // this computer's clock
};

// `before` may be null: the first.
RevisionRecord DescribeRevision(const MapSnapshot* before, const MapSnapshot& after);

// The newest `capacity` records. Not thread-safe.
class RevisionHistory {
 public:
  explicit RevisionHistory(size_t capacity = 1000) : capacity_(capacity) {}

  // Revisions increase.
  void Add(std::shared_ptr<const MapSnapshot> snapshot);

  // In place of what is there; `newest` is what the last record led to.
  void Restore(const std::vector<RevisionRecord>& records,
               std::shared_ptr<const MapSnapshot> newest);

  // Ids of the closures that were in use at a revision. NotFound: not kept, or of another epoch.
  absl::StatusOr<std::set<std::string>> InUseAt(uint64_t revision) const;

  const std::deque<RevisionRecord>& records() const { return records_; }

 private:
  size_t capacity_;
  std::deque<RevisionRecord> records_;  // oldest first
  std::shared_ptr<const MapSnapshot> newest_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_REVISION_HISTORY_H_
