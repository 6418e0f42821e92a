// SPDX-License-Identifier: Apache-2.0
// Blobs that come, and blobs that will not; the snapshot.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_BLOB_OPERATIONS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_BLOB_OPERATIONS_H_

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/services/mapping_server/submap_store/store_operation.h"

namespace overtone {

class PutBlobOperation : public StoreOperation {
 public:
  using Done = std::function<void(absl::Status)>;
  PutBlobOperation(std::string lane, std::string sha256, SharedBlob blob, Done done)
      : lane_(std::move(lane)),
        sha256_(std::move(sha256)),
        blob_(std::move(blob)),
        done_(std::move(done)) {}

  std::string lane() const override { return lane_; }
  int64_t bytes() const override { return static_cast<int64_t>(blob_->size()); }
  absl::Status Write(BatchPlan& plan, StoreTables& tables) override;
  void Publish(StoreIndex& index, SinkCalls& calls) override;
  void Finish(const absl::Status& batch) override;

 private:
  const std::string lane_;
  const std::string sha256_;
  const SharedBlob blob_;
  const Done done_;
  absl::StatusOr<bool> added_ = false;
  int64_t id_ = 0;
};

// `keyframes` are not asked for any more: the index says so already. If it cannot be stored, they
// are asked for again after a restart.
class AbandonOperation : public StoreOperation {
 public:
  AbandonOperation(MissionId mission, std::string sha256, std::vector<NodeId> keyframes)
      : mission_(std::move(mission)),
        sha256_(std::move(sha256)),
        keyframes_(std::move(keyframes)) {}

  std::string lane() const override { return mission_.robot; }
  absl::Status Write(BatchPlan& plan, StoreTables& tables) override;
  void Publish(StoreIndex& index, SinkCalls& calls) override;
  void PublishUnstored(StoreIndex& index, SinkCalls& calls) override { Publish(index, calls); }
  void Finish(const absl::Status&) override {}

 private:
  const MissionId mission_;
  const std::string sha256_;
  const std::vector<NodeId> keyframes_;
};

class PutSnapshotOperation : public StoreOperation {
 public:
  using Done = std::function<void(absl::Status)>;
  PutSnapshotOperation(std::string bytes, Done done)
      : snapshot_(std::move(bytes)), done_(std::move(done)) {}

  std::string lane() const override { return "snapshot/"; }
  int64_t bytes() const override { return static_cast<int64_t>(snapshot_.size()); }
  absl::Status Write(BatchPlan& plan, StoreTables& tables) override;
  void Publish(StoreIndex&, SinkCalls&) override;
  void Finish(const absl::Status& batch) override { done_(batch); }

 private:
  const std::string snapshot_;
  const Done done_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_BLOB_OPERATIONS_H_
