// SPDX-License-Identifier: Apache-2.0
// What shrinks a store: a mission that is deleted, a blob that is damaged, space given back.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_MAINTENANCE_OPERATIONS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_MAINTENANCE_OPERATIONS_H_

#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "overtone/services/mapping_server/submap_store/loss_list.h"
#include "overtone/services/mapping_server/submap_store/store_operation.h"

namespace overtone {

// Rows of the log become empty ones, so that a position without a row always means damage.
class DeleteMissionOperation : public StoreOperation {
 public:
  using Done = std::function<void(absl::Status)>;
  DeleteMissionOperation(MissionId mission, Done done)
      : mission_(std::move(mission)), done_(std::move(done)) {}

  std::string lane() const override { return "maintenance/"; }
  bool alone() const override { return true; }
  absl::Status Write(BatchPlan& plan, StoreTables& tables) override;
  void Publish(StoreIndex& index, SinkCalls& calls) override;
  void Finish(const absl::Status& batch) override { done_(batch.ok() ? found_ : batch); }

 private:
  absl::Status EmptyLog(StoreTables& tables);
  absl::Status TakeClouds(StoreTables& tables, int64_t position);
  absl::Status DeleteAbandoned(StoreTables& tables);

  const MissionId mission_;
  const Done done_;
  absl::Status found_;
  int64_t submap_closures_ = 0;
  std::vector<std::string> sha256s_;   // of its clouds
  std::vector<std::string> closures_;  // digests of those that go with it
};

// Gives some of the free pages back to the file system; `done` with how many are left.
class VacuumOperation : public StoreOperation {
 public:
  using Done = std::function<void(absl::StatusOr<int64_t>)>;
  explicit VacuumOperation(Done done) : done_(std::move(done)) {}

  std::string lane() const override { return "maintenance/"; }
  bool alone() const override { return true; }
  absl::Status Write(BatchPlan& plan, StoreTables& tables) override;
  void Publish(StoreIndex&, SinkCalls&) override {}
  void Finish(const absl::Status& batch) override;

 private:
  const Done done_;
  int64_t left_ = 0;
};

// A blob cannot be read or has another checksum: it is set aside, and its clouds are wanted again
// from their missions, except those that said they cannot send it.
class LoseBlobOperation : public StoreOperation {
 public:
  // `losses` outlives the operation.
  LoseBlobOperation(std::string sha256, LossList* losses)
      : sha256_(std::move(sha256)), losses_(losses) {}

  std::string lane() const override { return "maintenance/"; }
  bool alone() const override { return true; }
  absl::Status Write(BatchPlan& plan, StoreTables& tables) override;
  void Publish(StoreIndex& index, SinkCalls& calls) override;
  void Finish(const absl::Status&) override {}

 private:
  // All clouds of the log that are this blob.
  absl::Status FindClouds(StoreTables& tables);

  const std::string sha256_;
  LossList* const losses_;
  std::string what_;  // empty: it is gone already, or whole after all
  std::vector<std::pair<MissionId, KeyframeCloud>> clouds_;
  std::vector<MissionId> abandoned_by_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_MAINTENANCE_OPERATIONS_H_
