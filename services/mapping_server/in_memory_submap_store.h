// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_IN_MEMORY_SUBMAP_STORE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_IN_MEMORY_SUBMAP_STORE_H_

#include <map>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_map.h"
#include "absl/container/flat_hash_set.h"
#include "absl/synchronization/mutex.h"
#include "overtone/services/mapping_server/cloud_ledger.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/services/mapping_server/submap_store.h"

namespace overtone {

// Lasts as long as the process. Of submaps it keeps digests only, 32 bytes each; the content lives
// on in the map that the sink feeds. Blobs are kept whole. Calls every `done` before it returns.
class InMemorySubmapStore : public SubmapStore {
 public:
  InMemorySubmapStore(const ServerLimits& limits, Sink sink);

  absl::Status Replay() override { return absl::OkStatus(); }
  void Append(SubmapRecord record, std::function<void(absl::StatusOr<AppendResult>)> done) override;
  void AppendLoopClosures(std::vector<LoopClosureRecord> records,
                          std::function<void(absl::StatusOr<int>)> done) override;
  void AppendFinding(FindingRecord record, std::function<void(absl::Status)> done) override;
  void PutSnapshot(std::string bytes, std::function<void(absl::Status)> done) override;
  absl::StatusOr<std::string> GetSnapshot() const override;
  absl::Status DeleteMission(const MissionId& mission) override;
  void Drain() override {}
  StoreReport Verify() const override { return StoreReport(); }
  absl::Status Backup(const std::string& path) const override;
  void PutBlob(const std::string& sha256, SharedBlob blob,
               std::function<void(absl::Status)> done) override;
  absl::StatusOr<SharedBlob> GetBlob(const std::string& sha256) const override;
  void AbandonBlob(const MissionId& mission, const std::string& sha256) override;
  std::vector<MissingBlob> MissingBlobs(const MissionId& mission, size_t max) const override;
  CloudCounts Clouds() const override;
  UploadState State(const MissionId& mission) const override;
  std::map<MissionId, UploadState> Missions() const override;

 private:
  struct Mission {
    UploadState state;
    std::vector<std::string> digests;  // by sequence
  };

  absl::StatusOr<AppendResult> Add(const SubmapRecord& record) ABSL_LOCKS_EXCLUDED(mutex_);
  absl::StatusOr<int> AddLoopClosures(const std::vector<LoopClosureRecord>& records)
      ABSL_LOCKS_EXCLUDED(mutex_);
  absl::Status AddBlob(const std::string& sha256, SharedBlob blob) ABSL_LOCKS_EXCLUDED(mutex_);
  // The submap is stored: its clouds are too, or wait for their blobs.
  void AddClouds(const SubmapRecord& record) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void TellCloud(const NodeId& keyframe, const std::string& sha256)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  UploadState StateOf(const MissionId& mission) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  absl::Status CheckLimits(const SubmapRecord& record, const UploadState& state) const
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const ServerLimits limits_;
  const Sink sink_;
  mutable absl::Mutex mutex_;
  std::map<MissionId, Mission> missions_ ABSL_GUARDED_BY(mutex_);
  absl::flat_hash_set<std::string> closure_digests_ ABSL_GUARDED_BY(mutex_);
  // Those of submaps and those that came alone.
  int64_t num_closures_ ABSL_GUARDED_BY(mutex_) = 0;
  CloudLedger clouds_ ABSL_GUARDED_BY(mutex_);
  int64_t clouds_stored_ ABSL_GUARDED_BY(mutex_) = 0;
  int64_t blob_bytes_ ABSL_GUARDED_BY(mutex_) = 0;
  std::string snapshot_ ABSL_GUARDED_BY(mutex_);
  // Taken after mutex_, and alone by GetBlob, which the sink may call.
  mutable absl::Mutex blob_mutex_ ABSL_ACQUIRED_AFTER(mutex_);
  absl::flat_hash_map<std::string, SharedBlob> blobs_ ABSL_GUARDED_BY(blob_mutex_);
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_IN_MEMORY_SUBMAP_STORE_H_
