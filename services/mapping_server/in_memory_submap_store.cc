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
  const UploadState before = StateOf(record.mission);
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
  AddClouds(record);
  return AppendResult{true, StateOf(record.mission)};
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

void InMemorySubmapStore::AppendFinding(FindingRecord record,
                                        std::function<void(absl::Status)> done) {
  {
    absl::MutexLock lock(&mutex_);
    sink_.on_finding(record.bytes);
  }
  done(absl::OkStatus());
}

void InMemorySubmapStore::PutSnapshot(std::string bytes, std::function<void(absl::Status)> done) {
  {
    absl::MutexLock lock(&mutex_);
    snapshot_ = std::move(bytes);
  }
  done(absl::OkStatus());
}

absl::StatusOr<std::string> InMemorySubmapStore::GetSnapshot() const {
  absl::MutexLock lock(&mutex_);
  if (snapshot_.empty()) return absl::NotFoundError("snapshot: none");
  return snapshot_;
}

absl::Status InMemorySubmapStore::DeleteMission(const MissionId&) {
  return absl::UnimplementedError("a store in memory deletes nothing");
}

absl::Status InMemorySubmapStore::Backup(const std::string&) const {
  return absl::UnimplementedError("a store in memory has nothing to copy");
}

void InMemorySubmapStore::AddClouds(const SubmapRecord& record) {
  for (const KeyframeCloud& cloud : record.submap->clouds) {
    if (GetBlob(cloud.sha256).ok()) {
      TellCloud({record.mission, cloud.index}, cloud.sha256);
    } else {
      clouds_.Await(record.mission, cloud);
    }
  }
}

void InMemorySubmapStore::TellCloud(const NodeId& keyframe, const std::string& sha256) {
  ++clouds_stored_;
  sink_.on_cloud(keyframe.mission, keyframe.index, sha256);
}

void InMemorySubmapStore::PutBlob(const std::string& sha256, SharedBlob blob,
                                  std::function<void(absl::Status)> done) {
  done(AddBlob(sha256, std::move(blob)));
}

absl::Status InMemorySubmapStore::AddBlob(const std::string& sha256, SharedBlob blob) {
  absl::MutexLock lock(&mutex_);
  if (GetBlob(sha256).ok()) return absl::OkStatus();
  if (!clouds_.IsAwaited(sha256)) return absl::NotFoundError("blob: no cloud waits for it");
  const int64_t bytes = blob_bytes_ + static_cast<int64_t>(blob->size());
  if (bytes > limits_.max_stored_blob_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("blob: the map may keep ", limits_.max_stored_blob_bytes, " bytes of clouds"));
  }
  blob_bytes_ = bytes;
  {
    absl::MutexLock blob_lock(&blob_mutex_);
    blobs_[sha256] = std::move(blob);
  }
  for (const NodeId& keyframe : clouds_.Resolve(sha256)) TellCloud(keyframe, sha256);
  return absl::OkStatus();
}

absl::StatusOr<SharedBlob> InMemorySubmapStore::GetBlob(const std::string& sha256) const {
  absl::MutexLock lock(&blob_mutex_);
  const auto it = blobs_.find(sha256);
  if (it == blobs_.end()) return absl::NotFoundError("blob: not there");
  return it->second;
}

void InMemorySubmapStore::AbandonBlob(const MissionId& mission, const std::string& sha256) {
  absl::MutexLock lock(&mutex_);
  for (const NodeId& keyframe : clouds_.Abandon(mission, sha256)) {
    sink_.on_cloud_gone(keyframe.mission, keyframe.index);
  }
}

std::vector<MissingBlob> InMemorySubmapStore::MissingBlobs(const MissionId& mission,
                                                           size_t max) const {
  absl::MutexLock lock(&mutex_);
  return clouds_.Missing(mission, max);
}

CloudCounts InMemorySubmapStore::Clouds() const {
  absl::MutexLock lock(&mutex_);
  return {clouds_stored_, clouds_.NumMissing()};
}

UploadState InMemorySubmapStore::State(const MissionId& mission) const {
  absl::MutexLock lock(&mutex_);
  return StateOf(mission);
}

std::map<MissionId, UploadState> InMemorySubmapStore::Missions() const {
  absl::MutexLock lock(&mutex_);
  std::map<MissionId, UploadState> missions;
  for (const auto& [id, mission] : missions_) missions[id] = StateOf(id);
  return missions;
}

UploadState InMemorySubmapStore::StateOf(const MissionId& mission) const {
  const auto it = missions_.find(mission);
  if (it == missions_.end()) return UploadState();
  UploadState state = it->second.state;
  state.missing_blobs = clouds_.NumMissing(mission);
  return state;
}

}  // namespace overtone
