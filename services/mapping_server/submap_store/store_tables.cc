// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/store_tables.h"

#include <utility>
#include <vector>

#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/services/mapping_server/submap_store/log_compression.h"

namespace overtone {
namespace {

// Columns of `log`, the bytes last: SQLite reads a long row's pages only as far as it must.
constexpr absl::string_view kSelectLog =
    "SELECT position, kind, sequence, stored_us, about, digest, checksum, encoding, bytes FROM log "
    "WHERE position >= ? ORDER BY position";
constexpr absl::string_view kSelectLogAt =
    "SELECT position, kind, sequence, stored_us, about, digest, checksum, encoding, bytes FROM log "
    "WHERE position = ?";
constexpr absl::string_view kSelectLogHeaders =
    "SELECT position, kind, sequence, stored_us, about, digest, checksum FROM log "
    "ORDER BY position";

LogRow HeaderOf(const SqliteStatement& row) {
  LogRow log;
  log.position = row.Int(0);
  log.kind = static_cast<LogKind>(row.Int(1));
  log.sequence = row.Int(2);
  log.stored_us = row.Int(3);
  log.about = row.String(4);
  log.digest = row.String(5);
  return log;
}

absl::Status ReadLogRow(const SqliteStatement& row, const StoreTables::ReadLog& read) {
  LogRow log = HeaderOf(row);
  const std::string checksum = row.String(6);
  const auto encoding = static_cast<LogEncoding>(row.Int(7));
  log.bytes = DecodeLogBytes(encoding, row.Bytes(8));
  const RowDamage damage = DamageOf(log, checksum);
  return read(std::move(log), damage);
}

MissionId MissionOf(const SqliteStatement& row, int column) {
  std::vector<MissionId> missions = MissionsOf(row.Bytes(column));
  return missions.empty() ? MissionId() : std::move(missions.front());
}

}  // namespace

absl::StatusOr<std::unique_ptr<StoreTables>> StoreTables::Open(const std::string& path,
                                                               SqliteDatabase::Mode mode,
                                                               const std::string& vfs) {
  ASSIGN_OR_RETURN(std::unique_ptr<SqliteDatabase> database, SqliteDatabase::Open(path, mode, vfs));
  return std::unique_ptr<StoreTables>(new StoreTables(std::move(database)));
}

absl::StatusOr<SqliteStatement*> StoreTables::Statement(absl::string_view sql) {
  auto it = statements_.find(sql);
  if (it == statements_.end()) {
    ASSIGN_OR_RETURN(SqliteStatement statement, database_->Prepare(sql));
    it = statements_.emplace(sql, std::move(statement)).first;
  }
  return &it->second;
}

absl::Status StoreTables::DeleteRow(absl::string_view sql, int64_t id) {
  ASSIGN_OR_RETURN(SqliteStatement * erase, Statement(sql));
  return erase->BindInt(1, id).Run();
}

absl::StatusOr<bool> StoreTables::HasContent() {
  ASSIGN_OR_RETURN(const int64_t has_content,
                   database_->QueryInt("SELECT EXISTS(SELECT 1 FROM log) "
                                       "OR EXISTS(SELECT 1 FROM state) "
                                       "OR EXISTS(SELECT 1 FROM damaged)"));
  return has_content != 0;
}

absl::StatusOr<StateRow> StoreTables::GetState() {
  ASSIGN_OR_RETURN(
      SqliteStatement * select,
      Statement("SELECT store_id, log_end, commits, checksum FROM state WHERE id = 1"));
  StateRow state;
  bool whole = false;
  RETURN_IF_ERROR(select->ForEach([&](const SqliteStatement& row) {
    state = {row.String(0), row.Int(1), row.Int(2)};
    whole = row.Bytes(3) == Checksum(state);
    return absl::OkStatus();
  }));
  if (!whole) return absl::NotFoundError("state: not there or damaged");
  return state;
}

absl::Status StoreTables::PutState(const StateRow& row) {
  ASSIGN_OR_RETURN(SqliteStatement * put, Statement("REPLACE INTO state VALUES(1, ?, ?, ?, ?)"));
  const std::string checksum = Checksum(row);
  return put->BindBlob(1, row.store_id)
      .BindInt(2, row.log_end)
      .BindInt(3, row.commits)
      .BindBlob(4, checksum)
      .Run();
}

absl::Status StoreTables::PutLog(const LogRow& row) {
  ASSIGN_OR_RETURN(SqliteStatement * put,
                   Statement("REPLACE INTO log VALUES(?, ?, ?, ?, ?, ?, ?, ?, ?)"));
  const std::string checksum = Checksum(row);
  const EncodedLogBytes encoded = EncodeLogBytes(row.bytes);
  return put->BindInt(1, row.position)
      .BindInt(2, static_cast<int64_t>(row.kind))
      .BindInt(3, row.sequence)
      .BindInt(4, row.stored_us)
      .BindText(5, row.about)
      .BindBlob(6, row.digest)
      .BindBlob(7, checksum)
      .BindInt(8, static_cast<int64_t>(encoded.encoding))
      .BindBlob(9, encoded.bytes)
      .Run();
}

absl::Status StoreTables::ForEachLog(int64_t first, const ReadLog& read) {
  ASSIGN_OR_RETURN(SqliteStatement * select, Statement(kSelectLog));
  select->BindInt(1, first);
  return select->ForEach([&](const SqliteStatement& row) { return ReadLogRow(row, read); });
}

absl::Status StoreTables::ForEachLogHeader(const std::function<absl::Status(LogRow row)>& read) {
  ASSIGN_OR_RETURN(SqliteStatement * select, Statement(kSelectLogHeaders));
  return select->ForEach([&](const SqliteStatement& row) {
    LogRow log = HeaderOf(row);
    // What cannot be believed is about nothing; it is reported when it is read.
    return row.Bytes(6) == Checksum(log) ? read(std::move(log)) : absl::OkStatus();
  });
}

absl::Status StoreTables::ReadLogAt(int64_t position, const ReadLog& read) {
  ASSIGN_OR_RETURN(SqliteStatement * select, Statement(kSelectLogAt));
  absl::Status found = absl::NotFoundError("log: no such row");
  select->BindInt(1, position);
  RETURN_IF_ERROR(select->ForEach([&](const SqliteStatement& row) {
    found = ReadLogRow(row, read);
    return absl::OkStatus();
  }));
  return found;
}

absl::Status StoreTables::PutMission(const MissionRow& row) {
  ASSIGN_OR_RETURN(SqliteStatement * put, Statement("REPLACE INTO missions VALUES(?, ?, ?, ?)"));
  const std::string mission = ToString(row.mission);
  const std::string checksum = Checksum(row);
  return put->BindInt(1, row.id)
      .BindText(2, mission)
      .BindInt(3, row.next_sequence)
      .BindBlob(4, checksum)
      .Run();
}

absl::Status StoreTables::ForEachMission(const ReadRow<MissionRow>& read) {
  ASSIGN_OR_RETURN(SqliteStatement * select,
                   Statement("SELECT id, mission, next_sequence, checksum FROM missions"));
  return select->ForEach([&](const SqliteStatement& row) {
    const MissionRow mission = {row.Int(0), MissionOf(row, 1), row.Int(2)};
    return read(mission, Checksum(mission) != row.Bytes(3));
  });
}

absl::Status StoreTables::DeleteMission(int64_t id) {
  return DeleteRow("DELETE FROM missions WHERE id = ?", id);
}

absl::Status StoreTables::PutAbandoned(const AbandonedRow& row) {
  ASSIGN_OR_RETURN(SqliteStatement * put, Statement("REPLACE INTO abandoned VALUES(?, ?, ?, ?)"));
  const std::string mission = ToString(row.mission);
  const std::string checksum = Checksum(row);
  return put->BindInt(1, row.id)
      .BindText(2, mission)
      .BindBlob(3, row.sha256)
      .BindBlob(4, checksum)
      .Run();
}

absl::Status StoreTables::ForEachAbandoned(const ReadRow<AbandonedRow>& read) {
  ASSIGN_OR_RETURN(SqliteStatement * select,
                   Statement("SELECT id, mission, sha256, checksum FROM abandoned"));
  return select->ForEach([&](const SqliteStatement& row) {
    const AbandonedRow abandoned = {row.Int(0), MissionOf(row, 1), row.String(2)};
    return read(abandoned, Checksum(abandoned) != row.Bytes(3));
  });
}

absl::Status StoreTables::DeleteAbandoned(int64_t id) {
  return DeleteRow("DELETE FROM abandoned WHERE id = ?", id);
}

absl::Status StoreTables::PutBlob(int64_t id, const std::string& sha256, absl::string_view bytes) {
  ASSIGN_OR_RETURN(SqliteStatement * put, Statement("REPLACE INTO blobs VALUES(?, ?, ?)"));
  return put->BindInt(1, id).BindBlob(2, sha256).BindBlob(3, bytes).Run();
}

absl::StatusOr<StoreTables::StoredBlob> StoreTables::GetBlob(int64_t id) {
  ASSIGN_OR_RETURN(SqliteStatement * select,
                   Statement("SELECT sha256, bytes FROM blobs WHERE id = ?"));
  absl::StatusOr<StoredBlob> blob = absl::NotFoundError("blob: not there");
  select->BindInt(1, id);
  RETURN_IF_ERROR(select->ForEach([&](const SqliteStatement& row) {
    blob = StoredBlob{row.String(0), row.String(1)};
    return absl::OkStatus();
  }));
  return blob;
}

absl::Status StoreTables::DeleteBlob(int64_t id) {
  return DeleteRow("DELETE FROM blobs WHERE id = ?", id);
}

absl::Status StoreTables::ForEachBlob(
    const std::function<absl::Status(int64_t, const std::string&, int64_t)>& read) {
  ASSIGN_OR_RETURN(SqliteStatement * select,
                   Statement("SELECT id, sha256, length(bytes) FROM blobs ORDER BY id"));
  return select->ForEach(
      [&](const SqliteStatement& row) { return read(row.Int(0), row.String(1), row.Int(2)); });
}

absl::Status StoreTables::PutSnapshot(int64_t stored_us, absl::string_view bytes) {
  ASSIGN_OR_RETURN(SqliteStatement * put, Statement("REPLACE INTO snapshot VALUES(1, ?, ?, ?)"));
  const std::string digest = Sha256(bytes);
  return put->BindInt(1, stored_us).BindBlob(2, digest).BindBlob(3, bytes).Run();
}

absl::StatusOr<std::string> StoreTables::GetSnapshot() {
  ASSIGN_OR_RETURN(SqliteStatement * select,
                   Statement("SELECT digest, bytes FROM snapshot WHERE id = 1"));
  absl::StatusOr<std::string> snapshot = absl::NotFoundError("snapshot: none");
  RETURN_IF_ERROR(select->ForEach([&](const SqliteStatement& row) {
    if (Sha256(row.Bytes(1)) == row.Bytes(0)) {
      snapshot = row.String(1);
    } else {
      snapshot = absl::DataLossError("snapshot: its checksum is wrong");
    }
    return absl::OkStatus();
  }));
  return snapshot;
}

absl::Status StoreTables::DeleteSnapshot() {
  return DeleteRow("DELETE FROM snapshot WHERE id = ?", 1);
}

absl::Status StoreTables::AddDamaged(int64_t found_us, absl::string_view what,
                                     absl::string_view bytes) {
  ASSIGN_OR_RETURN(SqliteStatement * add, Statement("INSERT INTO damaged VALUES(NULL, ?, ?, ?)"));
  return add->BindInt(1, found_us).BindText(2, what).BindBlob(3, bytes).Run();
}

absl::Status StoreTables::ForEachDamaged(
    const std::function<absl::Status(const std::string& what)>& read) {
  ASSIGN_OR_RETURN(SqliteStatement * select, Statement("SELECT what FROM damaged ORDER BY id"));
  return select->ForEach([&](const SqliteStatement& row) { return read(row.String(0)); });
}

}  // namespace overtone
