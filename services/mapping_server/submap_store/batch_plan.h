// SPDX-License-Identifier: Apache-2.0
// One transaction in the making: the rules of the store, applied to what is durable and to what
// the same batch adds before.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_BATCH_PLAN_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_BATCH_PLAN_H_

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "absl/container/flat_hash_set.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/services/mapping_server/submap_store.h"
#include "overtone/services/mapping_server/submap_store/store_index.h"

namespace overtone {

// The next free numbers: part of a batch, kept when it is committed.
struct StoreCounters {
  int64_t log_end = 0;
  int64_t blob_id = 0;
  int64_t mission_id = 0;
  int64_t abandoned_id = 0;
  std::map<MissionId, int64_t> mission_ids;
};

class BatchPlan {
 public:
  BatchPlan(const StoreIndex& index, const ServerLimits& limits, StoreCounters counters)
      : index_(index), limits_(limits), counters_(std::move(counters)) {}

  // True: new, and has to be written. False: there already, the same. Else why it is refused, as
  // SubmapStore says.
  absl::StatusOr<bool> AdmitSubmap(const SubmapRecord& record);
  absl::Status AdmitClosures(size_t count) const;
  bool AdmitClosure(const std::string& digest);
  absl::StatusOr<bool> AdmitBlob(const std::string& sha256, int64_t bytes);

  int64_t NextPosition() { return ++counters_.log_end; }
  int64_t NextBlobId() { return ++counters_.blob_id; }
  int64_t NextAbandonedId() { return ++counters_.abandoned_id; }
  int64_t RowOf(const MissionId& mission);
  void ForgetRowOf(const MissionId& mission) { counters_.mission_ids.erase(mission); }

  const StoreIndex& index() const { return index_; }
  const StoreCounters& counters() const { return counters_; }
  // Something was written.
  bool changes() const { return changes_; }
  void Changed() { changes_ = true; }

 private:
  struct Mission {
    UploadState state;
    std::map<int64_t, std::string> digests;  // of this batch
  };

  absl::Status CheckLimits(const SubmapRecord& record, const UploadState& state) const;
  absl::Status CheckMapLimits(const Submap& submap) const;
  bool HasMission(const MissionId& mission) const;

  const StoreIndex& index_;
  const ServerLimits& limits_;
  StoreCounters counters_;
  bool changes_ = false;
  std::map<MissionId, Mission> missions_;
  int64_t new_missions_ = 0;
  int64_t new_submaps_ = 0;
  int64_t new_keyframes_ = 0;
  int64_t new_closures_ = 0;
  absl::flat_hash_set<std::string> closures_;
  absl::flat_hash_set<std::string> blobs_;
  absl::flat_hash_set<std::string> awaited_;
  int64_t blob_bytes_ = 0;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_BATCH_PLAN_H_
