// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/store_index.h"

#include <utility>

namespace overtone {
namespace {

constexpr size_t kDigestBytes = 32;

}  // namespace

UploadState StoreIndex::State(const MissionId& mission) const {
  absl::ReaderMutexLock lock(&mutex_);
  return StateOf(mission);
}

UploadState StoreIndex::StateOf(const MissionId& mission) const {
  const auto it = missions_.find(mission);
  if (it == missions_.end()) return UploadState();
  UploadState state = it->second.state;
  state.missing_blobs = clouds_.NumMissing(mission);
  return state;
}

std::map<MissionId, UploadState> StoreIndex::Missions() const {
  absl::ReaderMutexLock lock(&mutex_);
  std::map<MissionId, UploadState> missions;
  for (const auto& [id, mission] : missions_) missions[id] = StateOf(id);
  return missions;
}

CloudCounts StoreIndex::Clouds() const {
  absl::ReaderMutexLock lock(&mutex_);
  return {clouds_stored_, clouds_.NumMissing()};
}

std::vector<MissingBlob> StoreIndex::Missing(const MissionId& mission, size_t max) const {
  absl::ReaderMutexLock lock(&mutex_);
  return clouds_.Missing(mission, max);
}

bool StoreIndex::HasMission(const MissionId& mission) const {
  absl::ReaderMutexLock lock(&mutex_);
  return missions_.count(mission) > 0;
}

bool StoreIndex::IsLost(const MissionId& mission) const {
  absl::ReaderMutexLock lock(&mutex_);
  const auto it = missions_.find(mission);
  return it != missions_.end() && it->second.lost;
}

std::string StoreIndex::Digest(const MissionId& mission, int64_t sequence) const {
  absl::ReaderMutexLock lock(&mutex_);
  return missions_.at(mission).digests.substr(sequence * kDigestBytes, kDigestBytes);
}

int64_t StoreIndex::NumMissions() const {
  absl::ReaderMutexLock lock(&mutex_);
  return static_cast<int64_t>(missions_.size());
}

int64_t StoreIndex::NumSubmaps() const {
  absl::ReaderMutexLock lock(&mutex_);
  return num_submaps_;
}

int64_t StoreIndex::NumKeyframes() const {
  absl::ReaderMutexLock lock(&mutex_);
  return num_keyframes_;
}

int64_t StoreIndex::NumBlobs() const {
  absl::ReaderMutexLock lock(&mutex_);
  return static_cast<int64_t>(blobs_.size());
}

int64_t StoreIndex::NumClosures() const {
  absl::ReaderMutexLock lock(&mutex_);
  return num_submap_closures_ + static_cast<int64_t>(closure_digests_.size());
}

bool StoreIndex::HasClosure(const std::string& digest) const {
  absl::ReaderMutexLock lock(&mutex_);
  return closure_digests_.contains(digest);
}

bool StoreIndex::IsAwaited(const std::string& sha256) const {
  absl::ReaderMutexLock lock(&mutex_);
  return clouds_.IsAwaited(sha256);
}

absl::optional<MissionId> StoreIndex::FirstWaiting(const std::string& sha256) const {
  absl::ReaderMutexLock lock(&mutex_);
  return clouds_.FirstWaiting(sha256);
}

absl::optional<IndexedBlob> StoreIndex::FindBlob(const std::string& sha256) const {
  absl::ReaderMutexLock lock(&mutex_);
  const auto it = blobs_.find(sha256);
  if (it == blobs_.end()) return absl::nullopt;
  return it->second;
}

int64_t StoreIndex::BlobBytes() const {
  absl::ReaderMutexLock lock(&mutex_);
  return blob_bytes_;
}

std::map<std::string, IndexedBlob> StoreIndex::Orphans() const {
  absl::ReaderMutexLock lock(&mutex_);
  std::map<std::string, IndexedBlob> orphans;
  for (const auto& [sha256, blob] : blobs_) {
    if (blob.references == 0) orphans[sha256] = blob;
  }
  return orphans;
}

std::vector<KeyframeCloud> StoreIndex::AddSubmap(const SubmapRecord& record, absl::Time stored_at) {
  const Submap& submap = *record.submap;
  absl::MutexLock lock(&mutex_);
  Mission& mission = missions_[record.mission];
  mission.digests += record.digest;
  mission.state.next_sequence = submap.sequence + 1;
  mission.state.next_index = submap.first_index + static_cast<int64_t>(submap.keyframes.size());
  mission.state.last_stamp = submap.keyframes.back().stamp;
  mission.state.stored_at = stored_at;
  ++num_submaps_;
  num_keyframes_ += static_cast<int64_t>(submap.keyframes.size());
  num_submap_closures_ += static_cast<int64_t>(submap.loop_closures.size());
  std::vector<KeyframeCloud> there;
  for (const KeyframeCloud& cloud : submap.clouds) {
    const auto blob = blobs_.find(cloud.sha256);
    if (blob == blobs_.end()) {
      clouds_.Await(record.mission, cloud);
      continue;
    }
    ++blob->second.references;
    ++clouds_stored_;
    there.push_back(cloud);
  }
  return there;
}

void StoreIndex::AddClosure(const std::string& digest) {
  absl::MutexLock lock(&mutex_);
  closure_digests_.insert(digest);
}

std::vector<NodeId> StoreIndex::AddBlob(const std::string& sha256, int64_t id, int64_t bytes) {
  absl::MutexLock lock(&mutex_);
  std::vector<NodeId> keyframes = clouds_.Resolve(sha256);
  blobs_[sha256] = {id, bytes, static_cast<int64_t>(keyframes.size())};
  blob_bytes_ += bytes;
  clouds_stored_ += static_cast<int64_t>(keyframes.size());
  return keyframes;
}

std::vector<NodeId> StoreIndex::Abandon(const MissionId& mission, const std::string& sha256) {
  absl::MutexLock lock(&mutex_);
  return clouds_.Abandon(mission, sha256);
}

void StoreIndex::MarkLost(const MissionId& mission) {
  absl::MutexLock lock(&mutex_);
  missions_[mission].lost = true;
}

std::map<std::string, IndexedBlob> StoreIndex::SoleBlobs(
    const std::vector<std::string>& sha256s) const {
  absl::ReaderMutexLock lock(&mutex_);
  std::map<std::string, IndexedBlob> blobs;
  for (const std::string& sha256 : sha256s) {
    const auto it = blobs_.find(sha256);
    if (it != blobs_.end()) --blobs.emplace(sha256, it->second).first->second.references;
  }
  for (auto it = blobs.begin(); it != blobs.end();) {
    it = it->second.references > 0 ? blobs.erase(it) : std::next(it);
  }
  return blobs;
}

void StoreIndex::DropMission(const MissionId& mission, int64_t submap_closures,
                             const std::vector<std::string>& sha256s,
                             const std::vector<std::string>& closures) {
  absl::MutexLock lock(&mutex_);
  const auto dropped = missions_.find(mission);
  if (dropped != missions_.end()) {
    num_submaps_ -= dropped->second.state.next_sequence;
    num_keyframes_ -= dropped->second.state.next_index;
    missions_.erase(dropped);
  }
  clouds_.Forget(mission);
  num_submap_closures_ -= submap_closures;
  for (const std::string& digest : closures) closure_digests_.erase(digest);
  for (const std::string& sha256 : sha256s) {
    const auto it = blobs_.find(sha256);
    if (it == blobs_.end()) continue;
    --clouds_stored_;
    if (--it->second.references == 0) EraseBlob(sha256);
  }
}

void StoreIndex::LoseBlob(const std::string& sha256,
                          const std::vector<std::pair<MissionId, KeyframeCloud>>& clouds) {
  absl::MutexLock lock(&mutex_);
  const auto it = blobs_.find(sha256);
  if (it == blobs_.end()) return;
  clouds_stored_ -= it->second.references;
  EraseBlob(sha256);
  for (const auto& [mission, cloud] : clouds) clouds_.Await(mission, cloud);
}

void StoreIndex::DropBlob(const std::string& sha256) {
  absl::MutexLock lock(&mutex_);
  EraseBlob(sha256);
}

void StoreIndex::EraseBlob(const std::string& sha256) {
  const auto it = blobs_.find(sha256);
  if (it == blobs_.end()) return;
  blob_bytes_ -= it->second.bytes;
  blobs_.erase(it);
}

void StoreIndex::TakeFrom(StoreIndex& other) {
  absl::MutexLock lock(&mutex_);
  absl::MutexLock other_lock(&other.mutex_);
  missions_ = std::exchange(other.missions_, {});
  closure_digests_ = std::exchange(other.closure_digests_, {});
  num_submaps_ = std::exchange(other.num_submaps_, 0);
  num_keyframes_ = std::exchange(other.num_keyframes_, 0);
  num_submap_closures_ = std::exchange(other.num_submap_closures_, 0);
  clouds_ = std::exchange(other.clouds_, {});
  blobs_ = std::exchange(other.blobs_, {});
  clouds_stored_ = std::exchange(other.clouds_stored_, 0);
  blob_bytes_ = std::exchange(other.blob_bytes_, 0);
}

}  // namespace overtone
