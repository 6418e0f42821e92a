// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/store_salvage.h"

#include <cstdio>
#include <filesystem>
#include <system_error>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "absl/time/time.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/services/mapping_server/submap_store/raw_pages.h"
#include "overtone/services/mapping_server/submap_store/salvage_import.h"
#include "overtone/services/mapping_server/submap_store/store_format.h"
#include "overtone/services/mapping_server/submap_store/store_tables.h"
#include "overtone/services/mapping_server/submap_store/sync_file.h"

namespace overtone {

namespace {

// A salvage in the making, and one that is complete but not in its place yet.
std::string Unfinished(const std::string& path) { return path + ".salvage"; }
std::string Finished(const std::string& path) { return path + ".salvaged"; }

void RemoveStore(const std::string& path) {
  for (const char* suffix : {"", "-wal", "-shm"}) std::remove((path + suffix).c_str());
}

absl::Status Import(const std::string& from, const std::string& to, const std::string& vfs) {
  ASSIGN_OR_RETURN(const auto tables, StoreTables::Open(to, SqliteDatabase::Mode::kCreate, vfs));
  RETURN_IF_ERROR(ConfigureConnection(&tables->database()));
  RETURN_IF_ERROR(PrepareStore(&tables->database()));
  ASSIGN_OR_RETURN(SqliteTransaction transaction, SqliteTransaction::Begin(&tables->database()));
  SalvageImport import(tables.get());
  absl::Status status;
  ForEachRawRow(RawPages(from), [&](const RawRow& row) {
    if (status.ok()) status = import.Take(row);
  });
  RETURN_IF_ERROR(status);
  RETURN_IF_ERROR(import.Finish());
  RETURN_IF_ERROR(transaction.Commit());
  return tables->database().Checkpoint(SqliteDatabase::Checkpointing::kTruncate);
}

absl::Status Rename(const std::string& from, const std::string& to) {
  std::error_code error;
  std::filesystem::rename(from, to, error);
  if (!error) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat(to, ": ", error.message()));
}

// From `.salvaged` into place. Can be done again after a crash at any point: the old log goes
// first, because SQLite would take it for the new file's.
absl::StatusOr<std::string> PutInPlace(const std::string& path) {
  const std::string kept = absl::StrCat(
      path, ".damaged-", absl::FormatTime("%Y%m%dT%H%M%E6SZ", absl::Now(), absl::UTCTimeZone()));
  std::error_code error;
  if (std::filesystem::exists(path + "-wal", error)) {
    RETURN_IF_ERROR(Rename(path + "-wal", kept + "-wal"));
  }
  std::remove((path + "-shm").c_str());
  std::filesystem::create_hard_link(path, kept, error);
  RETURN_IF_ERROR(Rename(Finished(path), path));
  RETURN_IF_ERROR(SyncFolderOf(path));
  return kept;
}

}  // namespace

absl::Status CheckBeforeOpening(const std::string& path) {
  std::error_code error;
  if (std::filesystem::exists(Finished(path), error)) {
    RETURN_IF_ERROR(PutInPlace(path).status());
  }
  const auto size = std::filesystem::file_size(path, error);
  const auto log_size = error ? 0 : std::filesystem::file_size(path + "-wal", error);
  if (!error && size == 0 && log_size > 0) {
    return absl::DataLossError("the store's file is empty beside its log");
  }
  return absl::OkStatus();
}

absl::Status CheckStructure(SqliteDatabase* database) {
  ASSIGN_OR_RETURN(SqliteStatement check, database->Prepare("PRAGMA quick_check(1)"));
  ASSIGN_OR_RETURN(const bool row, check.Step());
  if (row && check.Bytes(0) == "ok") return absl::OkStatus();
  return absl::DataLossError(absl::StrCat("its pages do not fit together: ", check.Bytes(0)));
}

absl::Status SalvageStore(const std::string& path, const std::string& vfs, LossList* losses) {
  RemoveStore(Unfinished(path));
  absl::Status status = Import(path, Unfinished(path), vfs);
  if (status.ok()) status = Rename(Unfinished(path), Finished(path));
  if (!status.ok()) {
    RemoveStore(Unfinished(path));
    return status;
  }
  RETURN_IF_ERROR(SyncFolderOf(path));
  ASSIGN_OR_RETURN(const std::string kept, PutInPlace(path));
  losses->Add(
      absl::StrCat("the store's file was damaged: every whole row of it was taken over; it "
                   "is kept as ",
                   kept));
  return absl::OkStatus();
}

}  // namespace overtone
