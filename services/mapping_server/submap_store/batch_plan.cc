// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/batch_plan.h"

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/services/mapping_server/upload_rules.h"

namespace overtone {
namespace {

bool Exceeds(int64_t count, int64_t limit) { return limit > 0 && count > limit; }

}  // namespace

absl::StatusOr<bool> BatchPlan::AdmitSubmap(const SubmapRecord& record) {
  const Submap& submap = *record.submap;
  const auto it = missions_.find(record.mission);
  const UploadState before =
      it == missions_.end() ? index_.State(record.mission) : it->second.state;
  if (submap.sequence < before.next_sequence) {
    const bool in_batch = it != missions_.end() && it->second.digests.count(submap.sequence) > 0;
    const std::string digest = in_batch ? it->second.digests.at(submap.sequence)
                                        : index_.Digest(record.mission, submap.sequence);
    if (digest == record.digest) return false;
    return absl::AlreadyExistsError(
        absl::StrCat("sequence: ", submap.sequence, " is stored with other content"));
  }
  if (index_.IsLost(record.mission)) {
    return absl::DataLossError(absl::StrCat("mission: submap ", before.next_sequence,
                                            " was lost to damage; start a new mission"));
  }
  RETURN_IF_ERROR(CheckContinues(before, submap));
  RETURN_IF_ERROR(CheckLimits(record, before));

  if (!HasMission(record.mission)) ++new_missions_;
  Mission& mission = missions_[record.mission];
  mission.digests[submap.sequence] = record.digest;
  mission.state.next_sequence = submap.sequence + 1;
  mission.state.next_index = submap.first_index + static_cast<int64_t>(submap.keyframes.size());
  mission.state.last_stamp = submap.keyframes.back().stamp;
  ++new_submaps_;
  new_keyframes_ += static_cast<int64_t>(submap.keyframes.size());
  new_closures_ += static_cast<int64_t>(submap.loop_closures.size());
  for (const KeyframeCloud& cloud : submap.clouds) awaited_.insert(cloud.sha256);
  return true;
}

bool BatchPlan::HasMission(const MissionId& mission) const {
  return missions_.count(mission) > 0 || index_.HasMission(mission);
}

absl::Status BatchPlan::CheckLimits(const SubmapRecord& record, const UploadState& state) const {
  const Submap& submap = *record.submap;
  const int64_t num_keyframes = state.next_index + static_cast<int64_t>(submap.keyframes.size());
  if (num_keyframes > limits_.max_keyframes_per_mission) {
    return absl::ResourceExhaustedError(absl::StrCat(
        "keyframes: a mission may have ", limits_.max_keyframes_per_mission, "; start a new one"));
  }
  const int64_t num_missions = index_.NumMissions() + new_missions_;
  if (!HasMission(record.mission) && num_missions >= limits_.max_missions_per_map) {
    return absl::ResourceExhaustedError(
        absl::StrCat("mission: the map has ", num_missions, " already, its limit"));
  }
  RETURN_IF_ERROR(CheckMapLimits(submap));
  return AdmitClosures(submap.loop_closures.size());
}

absl::Status BatchPlan::CheckMapLimits(const Submap& submap) const {
  if (Exceeds(index_.NumSubmaps() + new_submaps_ + 1, limits_.max_submaps_per_map)) {
    return absl::ResourceExhaustedError(
        absl::StrCat("sequence: the map may have ", limits_.max_submaps_per_map, " submaps"));
  }
  const int64_t num_keyframes =
      index_.NumKeyframes() + new_keyframes_ + static_cast<int64_t>(submap.keyframes.size());
  if (Exceeds(num_keyframes, limits_.max_keyframes_per_map)) {
    return absl::ResourceExhaustedError(
        absl::StrCat("keyframes: the map may have ", limits_.max_keyframes_per_map));
  }
  return absl::OkStatus();
}

absl::Status BatchPlan::AdmitClosures(size_t count) const {
  const int64_t num_closures = index_.NumClosures() + new_closures_ + static_cast<int64_t>(count);
  if (num_closures <= limits_.max_loop_closures_per_map) return absl::OkStatus();
  return absl::ResourceExhaustedError(
      absl::StrCat("loop_closures: the map may have ", limits_.max_loop_closures_per_map));
}

bool BatchPlan::AdmitClosure(const std::string& digest) {
  if (index_.HasClosure(digest) || !closures_.insert(digest).second) return false;
  ++new_closures_;
  return true;
}

absl::StatusOr<bool> BatchPlan::AdmitBlob(const std::string& sha256, int64_t bytes) {
  if (index_.FindBlob(sha256).has_value() || blobs_.contains(sha256)) return false;
  if (!index_.IsAwaited(sha256) && !awaited_.contains(sha256)) {
    return absl::NotFoundError("blob: no cloud waits for it");
  }
  if (index_.BlobBytes() + blob_bytes_ + bytes > limits_.max_stored_blob_bytes) {
    return absl::ResourceExhaustedError(
        absl::StrCat("blob: the map may keep ", limits_.max_stored_blob_bytes, " bytes of clouds"));
  }
  const int64_t num_blobs = index_.NumBlobs() + static_cast<int64_t>(blobs_.size());
  if (Exceeds(num_blobs + 1, limits_.max_blobs_per_map)) {
    return absl::ResourceExhaustedError(
        absl::StrCat("blob: the map may keep ", limits_.max_blobs_per_map, " clouds"));
  }
  blobs_.insert(sha256);
  blob_bytes_ += bytes;
  return true;
}

int64_t BatchPlan::RowOf(const MissionId& mission) {
  const auto [it, is_new] = counters_.mission_ids.emplace(mission, counters_.mission_id + 1);
  if (is_new) ++counters_.mission_id;
  return it->second;
}

}  // namespace overtone
