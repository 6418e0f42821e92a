// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/revision_history.h"

#include <algorithm>
#include <iterator>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"

namespace overtone {
namespace {

std::set<std::string> ClosuresInUse(const MapSnapshot& snapshot) {
  std::set<std::string> ids;
  for (const ClosureRecord& record : snapshot.closures) {
    if (InUse(record.verdict)) ids.insert(record.id);
  }
  return ids;
}

// Closures keep their places: a later snapshot of the map has those of an earlier one first.
bool GoesOn(const std::vector<ClosureRecord>& before, const std::vector<ClosureRecord>& after) {
  return before.size() <= after.size() &&
         std::equal(before.begin(), before.end(), after.begin(),
                    [](const ClosureRecord& a, const ClosureRecord& b) { return a.id == b.id; });
}

void CompareClosures(const MapSnapshot* before, const MapSnapshot& after, RevisionRecord& record) {
  const std::vector<ClosureRecord> none;
  const std::vector<ClosureRecord>& old = before == nullptr ? none : before->closures;
  if (!GoesOn(old, after.closures)) {
    const std::set<std::string> old_ids = ClosuresInUse(*before);
    const std::set<std::string> new_ids = ClosuresInUse(after);
    std::set_difference(new_ids.begin(), new_ids.end(), old_ids.begin(), old_ids.end(),
                        std::back_inserter(record.accepted));
    std::set_difference(old_ids.begin(), old_ids.end(), new_ids.begin(), new_ids.end(),
                        std::back_inserter(record.dropped));
    return;
  }
  for (size_t k = 0; k < after.closures.size(); ++k) {
    const bool was_in_use = k < old.size() && InUse(old[k].verdict);
    const ClosureRecord& closure = after.closures[k];
    if (InUse(closure.verdict) == was_in_use) continue;
    (was_in_use ? record.dropped : record.accepted).push_back(closure.id);
  }
  std::sort(record.accepted.begin(), record.accepted.end());
  std::sort(record.dropped.begin(), record.dropped.end());
}

void MeasureMoves(const MapSnapshot& before, const MapSnapshot& after, RevisionRecord& record) {
  int64_t count = 0;
  double sum = 0;
  for (const SnapshotMission& mission : after.missions) {
    const auto old = std::find_if(before.missions.begin(), before.missions.end(),
                                  [&](const auto& other) { return other.id == mission.id; });
    if (old == before.missions.end() || !old->anchored || !mission.anchored) continue;
    for (size_t i = 0; i < old->map_from_body.size(); ++i) {
      const double move_m =
          (mission.map_from_body[i].translation - old->map_from_body[i].translation).norm();
      sum += move_m;
      ++count;
      record.largest_move_m = std::max(record.largest_move_m, move_m);
    }
  }
  if (count > 0) record.mean_move_m = sum / static_cast<double>(count);
}

}  // namespace

RevisionRecord DescribeRevision(const MapSnapshot* before, const MapSnapshot& after) {
  RevisionRecord record;
  record.revision = after.revision;
  record.map_epoch = after.map_epoch;
  record.missions = static_cast<int>(after.missions.size());
  for (const SnapshotMission& mission : after.missions) {
    record.anchored_missions += mission.anchored;
    record.components = std::max(record.components, mission.component + 1);
    record.keyframes += static_cast<int64_t>(mission.keyframes.size());
  }
  for (const ClosureRecord& closure : after.closures) ++record.verdicts[closure.verdict];
  CompareClosures(before, after, record);
  if (before != nullptr) MeasureMoves(*before, after, record);
  record.cost_before = after.initial_cost;
  record.cost_after = after.final_cost;
  record.optimisation_s = after.optimisation_s;
  return record;
}

void RevisionHistory::Add(std::shared_ptr<const MapSnapshot> snapshot) {
  records_.push_back(DescribeRevision(newest_.get(), *snapshot));
  records_.back().made = absl::Now();
  newest_ = std::move(snapshot);
  if (records_.size() > capacity_) records_.pop_front();
}

void RevisionHistory::Restore(const std::vector<RevisionRecord>& records,
                              std::shared_ptr<const MapSnapshot> newest) {
  records_.assign(records.begin(), records.end());
  newest_ = std::move(newest);
}

// Backwards from the newest: what a revision took into use was not in use before it.
absl::StatusOr<std::set<std::string>> RevisionHistory::InUseAt(uint64_t revision) const {
  std::set<std::string> ids;
  if (newest_ != nullptr) ids = ClosuresInUse(*newest_);
  for (auto record = records_.rbegin(); record != records_.rend(); ++record) {
    if (record->map_epoch != newest_->map_epoch) break;
    if (record->revision == revision) return ids;
    for (const std::string& id : record->accepted) ids.erase(id);
    ids.insert(record->dropped.begin(), record->dropped.end());
  }
  return absl::NotFoundError(
      absl::StrCat("revision: ", revision, " is not among those kept of the present epoch"));
}

}  // namespace overtone
