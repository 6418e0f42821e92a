// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/store_verify.h"

#include <filesystem>
#include <set>
#include <system_error>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/services/mapping_server/submap_store/log_entry.h"
#include "overtone/services/mapping_server/submap_store/store_format.h"
#include "overtone/services/mapping_server/submap_store/store_salvage.h"

namespace overtone {
namespace {

class Verification {
 public:
  explicit Verification(StoreTables* tables) : tables_(*tables) {}

  StoreReport Run() {
    Check(tables_.ForEachDamaged([this](const std::string& what) { return Lost(what); }));
    Check(CheckStructure(&tables_.database()));
    Check(CheckState());
    Check(tables_.ForEachLog(
        1, [this](const LogRow& row, RowDamage damage) { return CheckEntry(row, damage); }));
    if (next_ <= log_end_)
      Lose(absl::StrCat("log entries ", next_, " to ", log_end_, ": vanished"));
    Check(CheckMissions());
    Check(CheckBlobs());
    Check(CheckSnapshot());
    CountBytes();
    return std::move(report_);
  }

 private:
  void Lose(const std::string& what) { report_.losses.push_back(what); }
  absl::Status Lost(const std::string& what) {
    Lose(what);
    return absl::OkStatus();
  }
  void Check(const absl::Status& status) {
    if (!status.ok()) Lose(std::string(status.message()));
  }

  absl::Status CheckState() {
    const absl::StatusOr<StateRow> state = tables_.GetState();
    if (state.ok()) {
      log_end_ = state->log_end;
      return absl::OkStatus();
    }
    // A store that never took anything has none.
    ASSIGN_OR_RETURN(const int64_t rows, tables_.database().QueryInt("SELECT count(*) FROM log"));
    if (rows == 0 && absl::IsNotFound(state.status())) return absl::OkStatus();
    return Lost("the count of log entries is damaged");
  }

  absl::Status CheckEntry(const LogRow& row, RowDamage damage) {
    if (row.position > next_) {
      Lose(absl::StrCat("log entries ", next_, " to ", row.position - 1, ": vanished"));
    }
    next_ = row.position + 1;
    if (damage != RowDamage::kNone) return Lost(absl::StrCat(NameOf(row, damage), ": damaged"));
    report_.submaps += row.kind == LogKind::kSubmap;
    report_.loop_closures += row.kind == LogKind::kLoopClosure;
    report_.findings += row.kind == LogKind::kFinding;
    return absl::OkStatus();
  }

  absl::Status CheckMissions() {
    RETURN_IF_ERROR(tables_.ForEachAbandoned([this](const AbandonedRow& row, bool damaged) {
      return damaged ? Lost(absl::StrCat("abandoned cloud ", row.id, ": damaged"))
                     : absl::OkStatus();
    }));
    return tables_.ForEachMission([this](const MissionRow& row, bool damaged) {
      ++report_.missions;
      return damaged ? Lost(absl::StrCat("mission entry ", row.id, ": damaged")) : absl::OkStatus();
    });
  }

  // One at a time: a statement that stays open would keep the write-ahead log from being emptied.
  absl::Status CheckBlobs() {
    std::set<int64_t> ids;
    RETURN_IF_ERROR(tables_.ForEachBlob([&](int64_t id, const std::string&, int64_t) {
      ids.insert(id);
      return absl::OkStatus();
    }));
    for (const int64_t id : ids) {
      const absl::StatusOr<StoreTables::StoredBlob> blob = tables_.GetBlob(id);
      if (absl::IsNotFound(blob.status())) continue;  // deleted meanwhile
      RETURN_IF_ERROR(blob.status());
      ++report_.blobs;
      if (Sha256(blob->bytes) != blob->sha256) Lose(absl::StrCat("cloud ", id, ": damaged"));
    }
    return absl::OkStatus();
  }

  absl::Status CheckSnapshot() {
    const absl::Status status = tables_.GetSnapshot().status();
    return absl::IsNotFound(status) ? absl::OkStatus() : status;
  }

  void CountBytes() {
    const auto pages = tables_.database().QueryInt("PRAGMA page_count");
    const auto page_bytes = tables_.database().QueryInt("PRAGMA page_size");
    if (pages.ok() && page_bytes.ok()) report_.bytes_on_disk = *pages * *page_bytes;
  }

  StoreTables& tables_;
  StoreReport report_;
  int64_t log_end_ = 0;
  int64_t next_ = 1;
};

}  // namespace

StoreReport VerifyTables(StoreTables& tables) { return Verification(&tables).Run(); }

absl::StatusOr<StoreReport> VerifyStoreFile(const std::string& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    return absl::NotFoundError(absl::StrCat(path, ": there is no such file"));
  }
  RETURN_IF_ERROR(CheckBeforeOpening(path));
  ASSIGN_OR_RETURN(const auto tables,
                   StoreTables::Open(path, SqliteDatabase::Mode::kReadWrite, ""));
  RETURN_IF_ERROR(tables->database().Execute(
      "PRAGMA trusted_schema=OFF; PRAGMA cell_size_check=ON; PRAGMA query_only=ON"));
  RETURN_IF_ERROR(CheckStoreFormat(&tables->database()));
  RETURN_IF_ERROR(CheckStructure(&tables->database()));
  return VerifyTables(*tables);
}

}  // namespace overtone
