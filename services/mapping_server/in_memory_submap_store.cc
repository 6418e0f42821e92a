// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/in_memory_submap_store.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/services/mapping_server/upload_rules.h"

namespace overtone {

InMemorySubmapStore::InMemorySubmapStore(const ServerLimits& limits, Sink sink)
    : limits_(limits), sink_(std::move(sink)) {}

void InMemorySubmapStore::Append(SubmapRecord record,
                                 std::function<void(absl::StatusOr<AppendResult>)> done) {
  done(Add(record));
}

void InMemorySubmapStore::AppendLoopClosures(std::vector<LoopClosureRecord> records,
                                             std::function<void(absl::StatusOr<int>)> done) {
  done(AddLoopClosures(records));
}

absl::StatusOr<AppendResult> InMemorySubmapStore::Add(const SubmapRecord& record) {
  const Submap& submap = *record.submap;
  absl::MutexLock lock(&mutex_);
  const auto it = missions_.find(record.mission);
  const UploadState before = it == missions_.end() ? UploadState() : it->second.state;
  if (submap.sequence < before.next_sequence) {
    if (it->second.digests[submap.sequence] == record.digest) return AppendResult{false, before};
    return absl::AlreadyExistsError(
        absl::StrCat("sequence: ", submap.sequence, " is stored with other content"));
  }
  RETURN_IF_ERROR(CheckContinues(before, submap));
  RETURN_IF_ERROR(CheckLimits(record, before));

  Mission& mission = missions_[record.mission];
  mission.digests.push_back(record.digest);
  mission.state.next_sequence = submap.sequence + 1;
  mission.state.next_index = submap.first_index + static_cast<int64_t>(submap.keyframes.size());
  mission.state.last_stamp = submap.keyframes.back().stamp;
  mission.state.stored_at = absl::Now();
  num_closures_ += static_cast<int64_t>(submap.loop_closures.size());
  sink_.on_submap(record.mission, record.submap);
  return AppendResult{true, mission.state};
}

absl::Status InMemorySubmapStore::CheckLimits(const SubmapRecord& record,
                                              const UploadState& state) const {
  const Submap& submap = *record.submap;
  const int64_t num_keyframes = state.next_index + static_cast<int64_t>(submap.keyframes.size());
  if (num_keyframes > limits_.max_keyframes_per_mission) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "keyframes: a mission may have ", limits_.max_keyframes_per_mission, "; start a new one"));
  }
  if (missions_.count(record.mission) == 0 && missions_.size() >= limits_.max_missions_per_map) {
    return absl::ResourceExhaustedError(
        absl::StrCat("mission: the map has ", missions_.size(), " already, its limit"));
  }
  const int64_t num_closures = num_closures_ + static_cast<int64_t>(submap.loop_closures.size());
  if (num_closures > limits_.max_loop_closures_per_map) {
    return absl::ResourceExhaustedError(
        absl::StrCat("loop_closures: the map may have ", limits_.max_loop_closures_per_map));
  }
  return absl::OkStatus();
}

absl::StatusOr<int> InMemorySubmapStore::AddLoopClosures(
    const std::vector<LoopClosureRecord>& records) {
  absl::MutexLock lock(&mutex_);
  if (num_closures_ + static_cast<int64_t>(records.size()) > limits_.max_loop_closures_per_map) {
    return absl::ResourceExhaustedError(
        absl::StrCat("loop_closures: the map may have ", limits_.max_loop_closures_per_map));
  }
  int added = 0;
  for (const LoopClosureRecord& record : records) {
    if (!closure_digests_.insert(record.digest).second) continue;
    sink_.on_loop_closure(record.closure);
    ++num_closures_;
    ++added;
  }
  return added;
}

UploadState InMemorySubmapStore::State(const MissionId& mission) const {
  absl::MutexLock lock(&mutex_);
  const auto it = missions_.find(mission);
  return it == missions_.end() ? UploadState() : it->second.state;
}

std::map<MissionId, UploadState> InMemorySubmapStore::Missions() const {
  absl::MutexLock lock(&mutex_);
  std::map<MissionId, UploadState> missions;
  for (const auto& [id, mission] : missions_) missions[id] = mission.state;
  return missions;
}

}  // namespace overtone
