// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/store_format.h"

#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/services/mapping_server/submap_store/store_rows.h"

namespace overtone {
namespace {

// migrations[i] takes a file from version i to i + 1. Never edit one that was released.
//
// No secondary index and no table that another one implies: what can be computed from the log
// cannot disagree with it. Every row has its checksum (store_rows.h), rowids are given by us, and
// no two tables have the same number and types of columns: a salvage tells rows by these
// (salvage_import.cc).
//   format     its shape never changes: version, twice with user_version, so that damage to one
//              does not look like a newer file
//   state      how far the log goes and how often was committed: rows that vanish are missed
//   log        position: 1, 2, ... without gaps; what is deleted or lost leaves an empty row
//   missions   how far each one goes, so that the loss of its last submap shows
//   abandoned  blobs that a mission's robot cannot send
//   damaged    what was set aside, in words, and its bytes
constexpr const char* kMigrations[] = {
    R"(CREATE TABLE format(id INTEGER PRIMARY KEY, version INTEGER, checksum BLOB);
CREATE TABLE state(id INTEGER PRIMARY KEY, store_id BLOB, log_end INTEGER, commits INTEGER,
  checksum BLOB);
CREATE TABLE log(position INTEGER PRIMARY KEY, kind INTEGER, sequence INTEGER, stored_us INTEGER,
  about TEXT, digest BLOB, checksum BLOB, encoding INTEGER, bytes BLOB);
CREATE TABLE missions(id INTEGER PRIMARY KEY, mission TEXT, next_sequence INTEGER, checksum BLOB);
CREATE TABLE abandoned(id INTEGER PRIMARY KEY, mission TEXT, sha256 BLOB, checksum BLOB);
CREATE TABLE blobs(id INTEGER PRIMARY KEY, sha256 BLOB, bytes BLOB);
CREATE TABLE snapshot(id INTEGER PRIMARY KEY, stored_us INTEGER, digest BLOB, bytes BLOB);
CREATE TABLE damaged(id INTEGER PRIMARY KEY, found_us INTEGER, what TEXT, bytes BLOB);)",
};
static_assert(sizeof(kMigrations) / sizeof(kMigrations[0]) == kStoreFormatVersion);

absl::Status Migrate(SqliteDatabase* database, int from) {
  ASSIGN_OR_RETURN(SqliteTransaction transaction, SqliteTransaction::Begin(database));
  RETURN_IF_ERROR(database->Execute(kMigrations[from]));
  ASSIGN_OR_RETURN(SqliteStatement put, database->Prepare("REPLACE INTO format VALUES(1, ?, ?)"));
  const std::string checksum = FormatChecksum(from + 1);
  RETURN_IF_ERROR(put.BindInt(1, from + 1).BindBlob(2, checksum).Run());
  RETURN_IF_ERROR(database->Execute(absl::StrCat("PRAGMA user_version=", from + 1)));
  RETURN_IF_ERROR(database->Execute(absl::StrCat("PRAGMA application_id=", kStoreApplicationId)));
  return transaction.Commit();
}

absl::StatusOr<std::string> SchemaOf(SqliteDatabase* database) {
  ASSIGN_OR_RETURN(SqliteStatement select,
                   database->Prepare("SELECT type, name, tbl_name, sql FROM sqlite_schema "
                                     "ORDER BY name"));
  std::string schema;
  RETURN_IF_ERROR(select.ForEach([&](const SqliteStatement& row) {
    absl::StrAppend(&schema, row.Bytes(0), "|", row.Bytes(1), "|", row.Bytes(2), "|", row.Bytes(3),
                    "\n");
    return absl::OkStatus();
  }));
  return schema;
}

// That of an empty store.
absl::StatusOr<std::string> ReferenceSchema() {
  ASSIGN_OR_RETURN(const auto reference,
                   SqliteDatabase::Open(":memory:", SqliteDatabase::Mode::kCreate));
  for (int i = 0; i < kStoreFormatVersion; ++i) RETURN_IF_ERROR(Migrate(reference.get(), i));
  return SchemaOf(reference.get());
}

// A schema is code: SQLite would run the triggers and views of a file that somebody else made.
absl::Status CheckSchema(SqliteDatabase* database) {
  static const auto* const reference = new absl::StatusOr<std::string>(ReferenceSchema());
  RETURN_IF_ERROR(reference->status());
  ASSIGN_OR_RETURN(const std::string found, SchemaOf(database));
  if (found != **reference) return absl::DataLossError("the tables are not those of a store");
  return absl::OkStatus();
}

// 0: empty.
absl::StatusOr<int64_t> VersionOf(SqliteDatabase* database) {
  ASSIGN_OR_RETURN(const int64_t tables, database->QueryInt("SELECT count(*) FROM sqlite_schema"));
  ASSIGN_OR_RETURN(const int64_t version, database->QueryInt("PRAGMA user_version"));
  ASSIGN_OR_RETURN(const int64_t application, database->QueryInt("PRAGMA application_id"));
  if (tables == 0 && version == 0 && application == 0) return 0;
  if (application != kStoreApplicationId) return absl::DataLossError("this is not a store");
  absl::StatusOr<SqliteStatement> select =
      database->Prepare("SELECT version, checksum FROM format WHERE id = 1");
  if (!select.ok()) return absl::DataLossError("the tables are not those of a store");
  ASSIGN_OR_RETURN(const bool row, select->Step());
  if (!row || select->Int(0) != version || select->Bytes(1) != FormatChecksum(version)) {
    return absl::DataLossError("the format version is damaged");
  }
  if (version > kStoreFormatVersion) {
    return absl::FailedPreconditionError(absl::StrCat("this store has format version ", version,
                                                      ", this server knows only up to ",
                                                      kStoreFormatVersion, ": start a newer one"));
  }
  return version;
}

}  // namespace

absl::Status ConfigureConnection(SqliteDatabase* database) {
  // auto_vacuum counts only before the first table. Checkpoints are the writer's affair.
  // secure_delete: what was deleted is not found again when a damaged file is searched for rows.
  return database->Execute(
      "PRAGMA auto_vacuum=INCREMENTAL; PRAGMA journal_mode=WAL; PRAGMA synchronous=FULL;"
      "PRAGMA wal_autocheckpoint=0; PRAGMA journal_size_limit=16777216; PRAGMA trusted_schema=OFF;"
      "PRAGMA cell_size_check=ON; PRAGMA secure_delete=ON; PRAGMA temp_store=MEMORY;");
}

absl::Status PrepareStore(SqliteDatabase* database) {
  ASSIGN_OR_RETURN(const int64_t version, VersionOf(database));
  for (int i = static_cast<int>(version); i < kStoreFormatVersion; ++i) {
    RETURN_IF_ERROR(Migrate(database, i));
  }
  return CheckSchema(database);
}

absl::Status CheckStoreFormat(SqliteDatabase* database) {
  ASSIGN_OR_RETURN(const int64_t version, VersionOf(database));
  if (version == 0) return absl::DataLossError("this is not a store: it is empty");
  // The rows of every version so far are those of today.
  return version == kStoreFormatVersion ? CheckSchema(database) : absl::OkStatus();
}

}  // namespace overtone
