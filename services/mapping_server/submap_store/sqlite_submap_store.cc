// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/sqlite_submap_store.h"

#include <algorithm>
#include <utility>

#include "absl/synchronization/notification.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/services/mapping_server/submap_store/append_operations.h"
#include "overtone/services/mapping_server/submap_store/blob_operations.h"
#include "overtone/services/mapping_server/submap_store/maintenance_operations.h"
#include "overtone/services/mapping_server/submap_store/store_verify.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

// What `start(done)` is done with.
template <typename Result, typename Start>
Result Await(Start start) {
  Result result = absl::UnknownError("not done");
  absl::Notification done;
  start([&](Result r) {
    result = std::move(r);
    done.Notify();
  });
  done.WaitForNotification();
  return result;
}

}  // namespace

absl::StatusOr<std::unique_ptr<SqliteSubmapStore>> SqliteSubmapStore::Open(
    const std::string& path, const ServerLimits& limits, Sink sink, const StoreOptions& options) {
  auto losses = std::make_unique<LossList>();
  ASSIGN_OR_RETURN(std::unique_ptr<StoreFile> file,
                   StoreFile::Open(path, options.vfs, losses.get()));
  const absl::StatusOr<bool> has_content =
      file->Read([](StoreTables& tables) { return tables.HasContent(); });
  std::unique_ptr<SqliteSubmapStore> store(
      new SqliteSubmapStore(std::move(losses), std::move(file), limits, std::move(sink), options));
  const bool is_new = has_content.ok() && !*has_content && !store->file_->found_mark().has_value();
  if (is_new) RETURN_IF_ERROR(store->Replay());
  return store;
}

SqliteSubmapStore::SqliteSubmapStore(std::unique_ptr<LossList> losses,
                                     std::unique_ptr<StoreFile> file, const ServerLimits& limits,
                                     Sink sink, const StoreOptions& options)
    : losses_(std::move(losses)),
      file_(std::move(file)),
      writer_(file_.get(), &index_, losses_.get(), limits, std::move(sink), options) {}

SqliteSubmapStore::~SqliteSubmapStore() = default;

absl::Status SqliteSubmapStore::Replay() {
  if (writer_.started()) return absl::OkStatus();
  RETURN_IF_ERROR(writer_.Replay());
  writer_.Start();
  return absl::OkStatus();
}

void SqliteSubmapStore::Append(SubmapRecord record,
                               std::function<void(absl::StatusOr<AppendResult>)> done) {
  writer_.Push(std::make_unique<AppendSubmap>(std::move(record), std::move(done)));
}

void SqliteSubmapStore::AppendLoopClosures(std::vector<LoopClosureRecord> records,
                                           std::function<void(absl::StatusOr<int>)> done) {
  writer_.Push(std::make_unique<AppendClosures>(std::move(records), std::move(done)));
}

void SqliteSubmapStore::AppendFinding(FindingRecord record,
                                      std::function<void(absl::Status)> done) {
  writer_.Push(std::make_unique<overtone::AppendFinding>(std::move(record), std::move(done)));
}

void SqliteSubmapStore::PutBlob(const std::string& sha256, SharedBlob blob,
                                std::function<void(absl::Status)> done) {
  const absl::optional<MissionId> waiting = index_.FirstWaiting(sha256);
  writer_.Push(std::make_unique<PutBlobOperation>(waiting.has_value() ? waiting->robot : "", sha256,
                                                  std::move(blob), std::move(done)));
}

absl::StatusOr<SharedBlob> SqliteSubmapStore::GetBlob(const std::string& sha256) const {
  const absl::optional<IndexedBlob> indexed = index_.FindBlob(sha256);
  if (!indexed.has_value()) return absl::NotFoundError("blob: not there");
  absl::StatusOr<StoreTables::StoredBlob> blob =
      file_->Read([&](StoreTables& tables) { return tables.GetBlob(indexed->id); });
  if (blob.ok() && Sha256(blob->bytes) == sha256) {
    return std::make_shared<const std::string>(std::move(blob->bytes));
  }
  if (absl::IsResourceExhausted(blob.status())) return blob.status();
  // Deleted meanwhile.
  if (!index_.FindBlob(sha256).has_value()) return absl::NotFoundError("blob: not there");
  writer_.Push(std::make_unique<LoseBlobOperation>(sha256, losses_.get()));
  return absl::DataLossError("blob: damaged");
}

void SqliteSubmapStore::AbandonBlob(const MissionId& mission, const std::string& sha256) {
  std::vector<NodeId> keyframes = index_.Abandon(mission, sha256);
  if (keyframes.empty()) return;
  writer_.Push(std::make_unique<AbandonOperation>(mission, sha256, std::move(keyframes)));
}

std::vector<MissingBlob> SqliteSubmapStore::MissingBlobs(const MissionId& mission,
                                                         size_t max) const {
  return index_.Missing(mission, max);
}

void SqliteSubmapStore::PutSnapshot(std::string bytes, std::function<void(absl::Status)> done) {
  writer_.Push(std::make_unique<PutSnapshotOperation>(std::move(bytes), std::move(done)));
}

absl::StatusOr<std::string> SqliteSubmapStore::GetSnapshot() const {
  absl::StatusOr<std::string> snapshot =
      file_->Read([](StoreTables& tables) { return tables.GetSnapshot(); });
  if (!absl::IsDataLoss(snapshot.status())) return snapshot;
  losses_->Add(std::string(snapshot.status().message()));
  return absl::NotFoundError("snapshot: damaged");
}

absl::Status SqliteSubmapStore::DeleteMission(const MissionId& mission) {
  RETURN_IF_ERROR(Await<absl::Status>(
      [&](auto done) { writer_.Push(std::make_unique<DeleteMissionOperation>(mission, done)); }));
  // Step by step: appends go on in between.
  for (int64_t left = 1; left > 0;) {
    ASSIGN_OR_RETURN(left, Await<absl::StatusOr<int64_t>>([&](auto done) {
                       writer_.Push(std::make_unique<VacuumOperation>(done));
                     }));
  }
  const absl::Status status = file_->Write([](StoreTables& tables) {
    return tables.database().Checkpoint(SqliteDatabase::Checkpointing::kTruncate);
  });
  // A reader is in the way: the space goes back with a later checkpoint.
  if (!status.ok()) spdlog::info("store {}: {}", file_->path(), std::string(status.message()));
  return absl::OkStatus();
}

StoreReport SqliteSubmapStore::Verify() const {
  const absl::StatusOr<StoreReport> report =
      WithReader<StoreReport>([](StoreTables& tables) { return VerifyTables(tables); });
  StoreReport result = report.value_or(StoreReport());
  if (!report.ok()) losses_->Add(std::string(report.status().message()));
  for (const std::string& loss : losses_->All()) {
    const auto& all = result.losses;
    if (std::find(all.begin(), all.end(), loss) == all.end()) result.losses.push_back(loss);
  }
  return result;
}

absl::Status SqliteSubmapStore::Backup(const std::string& path) const {
  return WithReader<bool>([&](StoreTables& tables) -> absl::StatusOr<bool> {
           RETURN_IF_ERROR(BackUpStore(tables, path));
           return true;
         })
      .status();
}

template <typename Result>
absl::StatusOr<Result> SqliteSubmapStore::WithReader(
    const std::function<absl::StatusOr<Result>(StoreTables&)>& use) const {
  if (file_->in_memory()) return file_->Read(use);
  ASSIGN_OR_RETURN(const auto tables,
                   StoreTables::Open(file_->path(), SqliteDatabase::Mode::kReadOnly, file_->vfs()));
  return use(*tables);
}

}  // namespace overtone
