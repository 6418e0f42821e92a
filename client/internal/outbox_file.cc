// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/outbox_file.h"

#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/v1/submap.pb.h"

namespace overtone {
namespace {

constexpr int64_t kFormat = 1;

// EXCLUSIVE: the lock is held throughout, and there is no shared memory file. What is locked is
// not waited for. The write-ahead log does not stay large after a large transaction.
constexpr char kSettings[] =
    "PRAGMA busy_timeout = 0; PRAGMA locking_mode = EXCLUSIVE; PRAGMA journal_mode = WAL;"
    "PRAGMA synchronous = NORMAL; PRAGMA journal_size_limit = 4194304; PRAGMA temp_store = MEMORY;";

constexpr char kTables[] =
    "CREATE TABLE items (id INTEGER PRIMARY KEY, kind INTEGER NOT NULL, sequence INTEGER NOT NULL,"
    "  first_index INTEGER NOT NULL, sha256 BLOB NOT NULL, size INTEGER NOT NULL,"
    "  checksum BLOB NOT NULL, bytes BLOB NOT NULL);"
    "CREATE TABLE position (id INTEGER PRIMARY KEY CHECK (id = 0), next_sequence INTEGER NOT NULL,"
    "  next_index INTEGER NOT NULL, last_stamp_ns INTEGER NOT NULL,"
    "  clouds_dropped INTEGER NOT NULL);"
    "CREATE TABLE syncs (id INTEGER PRIMARY KEY CHECK (id = 0), count INTEGER NOT NULL);"
    "INSERT INTO syncs VALUES (0, 0);";

constexpr char kItemColumns[] = "id, kind, sequence, first_index, sha256, size";

OutboxItem ItemOf(const SqliteStatement& row) {
  OutboxItem item;
  item.id = row.Int(0);
  item.kind = static_cast<OutboxItem::Kind>(row.Int(1));
  item.sequence = row.Int(2);
  item.first_index = row.Int(3);
  item.sha256 = row.String(4);
  item.size = row.Int(5);
  item.saved = true;
  return item;
}

// The submap's own word on where its mission goes on; used when the stored position is lost.
void Follow(absl::string_view submap_bytes, OutboxPosition& position) {
  v1::Submap submap;
  if (!submap.ParseFromArray(submap_bytes.data(), static_cast<int>(submap_bytes.size()))) return;
  if (submap.sequence() < position.next_sequence || submap.keyframes().empty()) return;
  position.next_sequence = submap.sequence() + 1;
  position.next_index = submap.first_index() + submap.keyframes_size();
  position.last_stamp_ns = submap.keyframes(submap.keyframes_size() - 1).stamp_ns();
}

}  // namespace

absl::StatusOr<std::unique_ptr<OutboxFile>> OutboxFile::Open(const std::string& path,
                                                             const std::string& vfs) {
  ASSIGN_OR_RETURN(std::unique_ptr<SqliteDatabase> database,
                   SqliteDatabase::Open(path, SqliteDatabase::Mode::kCreate, vfs));
  std::unique_ptr<OutboxFile> file(new OutboxFile(std::move(database)));
  RETURN_IF_ERROR(file->Prepare());
  return file;
}

absl::Status OutboxFile::Prepare() {
  RETURN_IF_ERROR(database_->Execute(kSettings));
  RETURN_IF_ERROR(CreateTables());
  const auto prepare = [this](const char* sql,
                              std::unique_ptr<SqliteStatement>& target) -> absl::Status {
    ASSIGN_OR_RETURN(SqliteStatement statement, database_->Prepare(sql));
    target = std::make_unique<SqliteStatement>(std::move(statement));
    return absl::OkStatus();
  };
  RETURN_IF_ERROR(prepare("INSERT INTO items VALUES (?, ?, ?, ?, ?, ?, ?, ?)", insert_));
  RETURN_IF_ERROR(prepare("DELETE FROM items WHERE id = ?", remove_));
  RETURN_IF_ERROR(prepare("SELECT checksum, bytes FROM items WHERE id = ?", read_));
  return prepare("INSERT OR REPLACE INTO position VALUES (0, ?, ?, ?, ?)", set_position_);
}

absl::Status OutboxFile::CreateTables() {
  // Takes the lock, too.
  ASSIGN_OR_RETURN(SqliteTransaction transaction, SqliteTransaction::Begin(database_.get()));
  ASSIGN_OR_RETURN(const int64_t format, database_->QueryInt("PRAGMA user_version"));
  if (format == 0) {
    RETURN_IF_ERROR(database_->Execute(absl::StrCat(kTables, "PRAGMA user_version = ", kFormat)));
  } else if (format != kFormat) {
    return absl::DataLossError(absl::StrCat("format ", format, " is not known"));
  }
  return transaction.Commit();
}

absl::StatusOr<OutboxContent> OutboxFile::Load() {
  OutboxContent content;
  ASSIGN_OR_RETURN(content.position, LoadPosition());
  ASSIGN_OR_RETURN(
      SqliteStatement select,
      database_->Prepare(absl::StrCat("SELECT ", kItemColumns, " FROM items ORDER BY id")));
  RETURN_IF_ERROR(select.ForEach([&](const SqliteStatement& row) {
    content.items.push_back(ItemOf(row));
    return absl::OkStatus();
  }));
  return content;
}

absl::StatusOr<OutboxPosition> OutboxFile::LoadPosition() {
  OutboxPosition position;
  ASSIGN_OR_RETURN(
      SqliteStatement select,
      database_->Prepare(
          "SELECT next_sequence, next_index, last_stamp_ns, clouds_dropped FROM position"));
  RETURN_IF_ERROR(select.ForEach([&](const SqliteStatement& row) {
    position = {row.Int(0), row.Int(1), row.Int(2), row.Int(3)};
    return absl::OkStatus();
  }));
  return position;
}

absl::Status OutboxFile::Write(const std::vector<int64_t>& removed_ids,
                               const std::vector<OutboxItem>& added,
                               const OutboxPosition& position) {
  ASSIGN_OR_RETURN(SqliteTransaction transaction, SqliteTransaction::Begin(database_.get()));
  // First: what is added takes their room.
  for (const int64_t id : removed_ids) RETURN_IF_ERROR(remove_->BindInt(1, id).Run());
  for (const OutboxItem& item : added) {
    const std::string checksum = Sha256(*item.bytes);
    insert_->BindInt(1, item.id).BindInt(2, static_cast<int64_t>(item.kind));
    insert_->BindInt(3, item.sequence).BindInt(4, item.first_index).BindBlob(5, item.sha256);
    insert_->BindInt(6, item.size).BindBlob(7, checksum).BindBlob(8, *item.bytes);
    RETURN_IF_ERROR(insert_->Run());
  }
  set_position_->BindInt(1, position.next_sequence).BindInt(2, position.next_index);
  set_position_->BindInt(3, position.last_stamp_ns).BindInt(4, position.clouds_dropped);
  RETURN_IF_ERROR(set_position_->Run());
  return transaction.Commit();
}

absl::Status OutboxFile::Sync() {
  RETURN_IF_ERROR(database_->Execute("PRAGMA synchronous = FULL"));
  const absl::Status status = database_->Execute("UPDATE syncs SET count = count + 1");
  RETURN_IF_ERROR(database_->Execute("PRAGMA synchronous = NORMAL"));
  return status;
}

absl::StatusOr<SharedBytes> OutboxFile::Read(int64_t id) {
  SharedBytes bytes;
  RETURN_IF_ERROR(read_->BindInt(1, id).ForEach([&](const SqliteStatement& row) {
    bytes = std::make_shared<const std::string>(row.String(1));
    if (Sha256(*bytes) == row.Bytes(0)) return absl::OkStatus();
    return absl::DataLossError(absl::StrCat("item ", id, ": its checksum differs"));
  }));
  if (bytes == nullptr) return absl::NotFoundError(absl::StrCat("item ", id, ": not there"));
  return bytes;
}

OutboxContent OutboxFile::Salvage(OutboxFile& target) {
  OutboxContent copied;
  const absl::StatusOr<OutboxPosition> position = LoadPosition();
  if (position.ok()) copied.position = *position;
  if (!CopyItems(/*ascending=*/true, target, copied).ok()) {
    CopyItems(/*ascending=*/false, target, copied).IgnoreError();
  }
  std::sort(copied.items.begin(), copied.items.end(),
            [](const OutboxItem& a, const OutboxItem& b) { return a.id < b.id; });
  target.Write({}, {}, copied.position).IgnoreError();
  return copied;
}

// Ok: every row was visited. Items whose bytes differ from what was written are left out.
absl::Status OutboxFile::CopyItems(bool ascending, OutboxFile& target, OutboxContent& copied) {
  ASSIGN_OR_RETURN(SqliteStatement select,
                   database_->Prepare(absl::StrCat("SELECT ", kItemColumns,
                                                   ", checksum, bytes FROM items ORDER BY id ",
                                                   ascending ? "ASC" : "DESC")));
  return select.ForEach([&](const SqliteStatement& row) -> absl::Status {
    OutboxItem item = ItemOf(row);
    item.bytes = std::make_shared<const std::string>(row.String(7));
    if (Sha256(*item.bytes) != row.Bytes(6)) return absl::OkStatus();
    if (item.kind == OutboxItem::Kind::kSubmap) Follow(*item.bytes, copied.position);
    const absl::Status status = target.Write({}, {item}, copied.position);
    if (absl::IsAlreadyExists(status)) return absl::OkStatus();  // seen from the other end
    RETURN_IF_ERROR(status);
    item.bytes = nullptr;
    copied.items.push_back(std::move(item));
    return absl::OkStatus();
  });
}

}  // namespace overtone
