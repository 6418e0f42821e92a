// SPDX-License-Identifier: Apache-2.0
// What the log grows by: submaps, loop closures, findings.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_APPEND_OPERATIONS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_APPEND_OPERATIONS_H_

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "overtone/services/mapping_server/submap_store/store_operation.h"

namespace overtone {

class AppendSubmap : public StoreOperation {
 public:
  using Done = std::function<void(absl::StatusOr<AppendResult>)>;
  AppendSubmap(SubmapRecord record, Done done)
      : record_(std::move(record)), done_(std::move(done)) {}

  std::string lane() const override { return record_.mission.robot; }
  int64_t bytes() const override { return static_cast<int64_t>(record_.bytes.size()); }
  absl::Status Write(BatchPlan& plan, StoreTables& tables) override;
  void Publish(StoreIndex& index, SinkCalls& calls) override;
  void Finish(const absl::Status& batch) override;

 private:
  const SubmapRecord record_;
  const Done done_;
  absl::Time stored_at_;
  absl::StatusOr<bool> added_ = false;
  UploadState state_;
};

class AppendClosures : public StoreOperation {
 public:
  using Done = std::function<void(absl::StatusOr<int>)>;
  AppendClosures(std::vector<LoopClosureRecord> records, Done done)
      : records_(std::move(records)), done_(std::move(done)) {}

  std::string lane() const override;
  int64_t bytes() const override;
  absl::Status Write(BatchPlan& plan, StoreTables& tables) override;
  void Publish(StoreIndex& index, SinkCalls& calls) override;
  void Finish(const absl::Status& batch) override;

 private:
  const std::vector<LoopClosureRecord> records_;
  const Done done_;
  absl::Status admitted_;
  std::vector<const LoopClosureRecord*> added_;
};

class AppendFinding : public StoreOperation {
 public:
  using Done = std::function<void(absl::Status)>;
  AppendFinding(FindingRecord record, Done done)
      : record_(std::move(record)), done_(std::move(done)) {}

  // The server's own: not behind any robot's backlog.
  std::string lane() const override { return "findings/"; }
  int64_t bytes() const override { return static_cast<int64_t>(record_.bytes.size()); }
  absl::Status Write(BatchPlan& plan, StoreTables& tables) override;
  void Publish(StoreIndex& index, SinkCalls& calls) override;
  void Finish(const absl::Status& batch) override { done_(batch); }

 private:
  const FindingRecord record_;
  const Done done_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_APPEND_OPERATIONS_H_
