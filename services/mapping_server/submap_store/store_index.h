// SPDX-License-Identifier: Apache-2.0
// What is durable, without the bytes: how far each mission is, digests, which blobs are there and
// which are wanted. Answers what a robot asks without reading a file.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_INDEX_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_INDEX_H_

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/synchronization/mutex.h"
#include "absl/types/optional.h"
#include "overtone/services/mapping_server/cloud_ledger.h"
#include "overtone/services/mapping_server/submap_store.h"

namespace overtone {

// A blob that is stored: its row, and how many keyframes' clouds it is.
struct IndexedBlob {
  int64_t id = 0;
  int64_t bytes = 0;
  int64_t references = 0;
};

// Thread-safe. But for Abandon, changed by the writer alone, after the commit.
class StoreIndex {
 public:
  UploadState State(const MissionId& mission) const;
  std::map<MissionId, UploadState> Missions() const;
  CloudCounts Clouds() const;
  std::vector<MissingBlob> Missing(const MissionId& mission, size_t max) const;

  bool HasMission(const MissionId& mission) const;
  bool IsLost(const MissionId& mission) const;
  // Of a submap that is there.
  std::string Digest(const MissionId& mission, int64_t sequence) const;
  int64_t NumMissions() const;
  int64_t NumSubmaps() const;
  int64_t NumKeyframes() const;
  int64_t NumBlobs() const;
  // Those of submaps and those that came alone.
  int64_t NumClosures() const;
  bool HasClosure(const std::string& digest) const;
  bool IsAwaited(const std::string& sha256) const;
  absl::optional<MissionId> FirstWaiting(const std::string& sha256) const;
  absl::optional<IndexedBlob> FindBlob(const std::string& sha256) const;
  int64_t BlobBytes() const;
  // Blobs that no cloud refers to.
  std::map<std::string, IndexedBlob> Orphans() const;

  // The submap's clouds whose blobs are there.
  std::vector<KeyframeCloud> AddSubmap(const SubmapRecord& record, absl::Time stored_at);
  void AddClosure(const std::string& digest);
  // The keyframes that waited for it.
  std::vector<NodeId> AddBlob(const std::string& sha256, int64_t id, int64_t bytes);
  // Those that were asked for until now.
  std::vector<NodeId> Abandon(const MissionId& mission, const std::string& sha256);
  void MarkLost(const MissionId& mission);

  // What of a mission's clouds is there and belongs to no other mission.
  std::map<std::string, IndexedBlob> SoleBlobs(const std::vector<std::string>& sha256s) const;
  // `sha256s`: of its clouds, once for each; `closures`: digests, of those that go with it.
  void DropMission(const MissionId& mission, int64_t submap_closures,
                   const std::vector<std::string>& sha256s,
                   const std::vector<std::string>& closures);
  // The blob is gone: `clouds` are all that refer to it, and are wanted again.
  void LoseBlob(const std::string& sha256,
                const std::vector<std::pair<MissionId, KeyframeCloud>>& clouds);
  void DropBlob(const std::string& sha256);
  // As `other`, which is empty afterwards.
  void TakeFrom(StoreIndex& other);

 private:
  struct Mission {
    UploadState state;
    std::string digests;  // 32 bytes each, by sequence
    bool lost = false;
  };

  UploadState StateOf(const MissionId& mission) const ABSL_SHARED_LOCKS_REQUIRED(mutex_);
  void EraseBlob(const std::string& sha256) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  mutable absl::Mutex mutex_;
  std::map<MissionId, Mission> missions_ ABSL_GUARDED_BY(mutex_);
  absl::flat_hash_set<std::string> closure_digests_ ABSL_GUARDED_BY(mutex_);
  int64_t num_submaps_ ABSL_GUARDED_BY(mutex_) = 0;
  int64_t num_keyframes_ ABSL_GUARDED_BY(mutex_) = 0;
  int64_t num_submap_closures_ ABSL_GUARDED_BY(mutex_) = 0;
  CloudLedger clouds_ ABSL_GUARDED_BY(mutex_);
  absl::flat_hash_map<std::string, IndexedBlob> blobs_ ABSL_GUARDED_BY(mutex_);
  int64_t clouds_stored_ ABSL_GUARDED_BY(mutex_) = 0;
  int64_t blob_bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_INDEX_H_
