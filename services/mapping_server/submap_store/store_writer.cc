// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/store_writer.h"

#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/services/mapping_server/failpoint.h"
#include "overtone/services/mapping_server/log_fields.h"
#include "spdlog/spdlog.h"

namespace overtone {

StoreWriter::StoreWriter(StoreFile* file, StoreIndex* index, LossList* losses,
                         const ServerLimits& limits, SubmapStore::Sink sink,
                         const StoreOptions& options)
    : file_(file),
      index_(index),
      losses_(losses),
      limits_(limits),
      sink_(std::move(sink)),
      options_(options) {}

StoreWriter::~StoreWriter() {
  queue_.Close();
  if (thread_.joinable()) {
    thread_.join();
    return;
  }
  const absl::Status closed = absl::UnavailableError("the store is closed");
  while (queue_.Wait()) {
    OperationBatch batch;
    queue_.Extend(batch, options_.batch)->Finish(closed);
  }
}

void StoreWriter::Push(std::unique_ptr<StoreOperation> operation) {
  queue_.Push(std::move(operation));
}

void StoreWriter::Start() {
  thread_ = std::thread([this] { Run(); });
}

absl::Status StoreWriter::Replay() {
  int64_t told = 0;
  absl::Status status;
  // Twice: a salvaged file is whole.
  for (int attempt = 0; attempt < 3; ++attempt) {
    StoreIndex index;
    status = file_->Write([&](StoreTables& tables) {
      StoreReplay replay(&tables, index_, &sink_, losses_);
      const absl::Status result = replay.Run(file_->found_mark(), told);
      told = replay.told();
      state_ = replay.state();
      counters_ = replay.counters();
      return result;
    });
    if (!absl::IsDataLoss(status)) return status;
    losses_->Add(std::string(status.message()));
    index_->TakeFrom(index);
    RETURN_IF_ERROR(file_->Salvage());
  }
  return status;
}

absl::Status StoreWriter::Reload() {
  RETURN_IF_ERROR(file_->Salvage());
  StoreIndex index;
  RETURN_IF_ERROR(file_->Write([&](StoreTables& tables) {
    StoreReplay replay(&tables, &index, nullptr, losses_);
    const absl::Status status = replay.Run(state_, 0);
    if (status.ok()) {
      state_ = replay.state();
      counters_ = replay.counters();
    }
    return status;
  }));
  index_->TakeFrom(index);
  return absl::OkStatus();
}

void StoreWriter::Run() {
  const LogFields about = LogFieldsOf(options_.map);
  const LogScope scope(&about);
  while (queue_.Wait()) {
    queue_.Finished(Process());
    CheckpointIfDue();
  }
}

size_t StoreWriter::Process() {
  const auto begin = std::chrono::steady_clock::now();
  OperationBatch batch;
  queue_.Extend(batch, options_.batch);  // whatever happens, the queue moves on
  absl::Status status = Store(batch);
  const auto& operations = batch.operations;
  Count(status, operations.size(),
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count());
  if (!status.ok()) {
    if (!std::exchange(disk_fails_, true)) {
      spdlog::error("store {}: nothing can be stored: {}", file_->path(), status.ToString());
    }
    // Whatever it is: nothing is stored, and it may work again later.
    status = absl::ResourceExhaustedError(absl::StrCat("store: ", status.message()));
  } else if (std::exchange(disk_fails_, false)) {
    spdlog::info("store {}: works again", file_->path());
  }
  SinkCalls calls;
  for (const auto& operation : operations) {
    if (status.ok()) {
      operation->Publish(*index_, calls);
    } else {
      operation->PublishUnstored(*index_, calls);
    }
  }
  for (const auto& call : calls) call(sink_);
  Failpoint("store_before_ack");
  for (const auto& operation : operations) operation->Finish(status);
  return operations.size();
}

void StoreWriter::Count(const absl::Status& status, size_t operations, double seconds) {
  if (options_.instruments == nullptr) return;
  if (!status.ok()) {
    ++options_.instruments->errors;
    return;
  }
  options_.instruments->commit_s.Observe(seconds);
  options_.instruments->commit_entries.Observe(static_cast<double>(operations));
}

absl::Status StoreWriter::Store(OperationBatch& batch) {
  const auto attempt = [&](StoreTables& tables) { return TryToStore(batch, tables); };
  const absl::Status status = file_->Write(attempt);
  if (!absl::IsDataLoss(status)) return status;
  losses_->Add(std::string(status.message()));
  RETURN_IF_ERROR(Reload());
  return file_->Write(attempt);
}

absl::Status StoreWriter::TryToStore(OperationBatch& batch, StoreTables& tables) {
  Failpoint("store_before_write");
  ASSIGN_OR_RETURN(SqliteTransaction transaction, SqliteTransaction::Begin(&tables.database()));
  BatchPlan plan(*index_, limits_, counters_);
  for (const auto& operation : batch.operations) RETURN_IF_ERROR(operation->Write(plan, tables));
  while (StoreOperation* const next = queue_.Extend(batch, options_.batch)) {
    RETURN_IF_ERROR(next->Write(plan, tables));
  }
  if (!plan.changes()) return absl::OkStatus();
  StateRow state = state_;
  state.log_end = plan.counters().log_end;
  ++state.commits;
  RETURN_IF_ERROR(tables.PutState(state));
  Failpoint("store_after_write");
  Failpoint("store_before_commit");
  RETURN_IF_ERROR(transaction.Commit());
  Failpoint("store_after_commit");
  state_ = state;
  counters_ = plan.counters();
  file_->WriteMark(state_);
  return absl::OkStatus();
}

void StoreWriter::CheckpointIfDue() {
  const int due = queue_.empty() ? options_.checkpoint_pages_when_idle : options_.checkpoint_pages;
  const absl::Status status = file_->Write([due](StoreTables& tables) {
    if (tables.database().wal_pages() < due) return absl::OkStatus();
    return tables.database().Checkpoint(SqliteDatabase::Checkpointing::kPassive);
  });
  // Tried again after the next batch; damage shows there too.
  if (!status.ok())
    spdlog::warn("store {}: checkpoint: {}", file_->path(), std::string(status.message()));
}

}  // namespace overtone
