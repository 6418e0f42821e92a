// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/storage/sqlite_database.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "sqlite3.h"

namespace overtone {
namespace {

// Another connection's transaction of this process, or a backup: short.
constexpr int kBusyTimeoutMs = 5000;

absl::StatusCode CodeOf(int sqlite_code) {
  switch (sqlite_code & 0xff) {
    case SQLITE_FULL:
    case SQLITE_IOERR:
    case SQLITE_NOMEM:
    case SQLITE_READONLY:
      return absl::StatusCode::kResourceExhausted;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
    case SQLITE_FORMAT:
      return absl::StatusCode::kDataLoss;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return absl::StatusCode::kUnavailable;
    case SQLITE_CANTOPEN:
      return absl::StatusCode::kNotFound;
    case SQLITE_CONSTRAINT:
      return absl::StatusCode::kAlreadyExists;
    default:
      return absl::StatusCode::kInternal;
  }
}

int FlagsOf(SqliteDatabase::Mode mode) {
  switch (mode) {
    case SqliteDatabase::Mode::kReadOnly:
      return SQLITE_OPEN_READONLY;
    case SqliteDatabase::Mode::kReadWrite:
      return SQLITE_OPEN_READWRITE;
    case SqliteDatabase::Mode::kCreate:
      return SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
  }
  return SQLITE_OPEN_READONLY;
}

}  // namespace

absl::Status SqliteError(int code, absl::string_view message) {
  // A damaged header: SQLite has no code of its own for it.
  if (message == "unsupported file format") code = SQLITE_CORRUPT;
  return absl::Status(CodeOf(code), absl::StrCat("database: ", message));
}

SqliteStatement::SqliteStatement(SqliteStatement&& other) noexcept
    : statement_(std::exchange(other.statement_, nullptr)) {}

SqliteStatement& SqliteStatement::operator=(SqliteStatement&& other) noexcept {
  std::swap(statement_, other.statement_);
  return *this;
}

SqliteStatement::~SqliteStatement() { sqlite3_finalize(statement_); }

// A parameter that does not exist shows as an error of Step: SQLite remembers it.
SqliteStatement& SqliteStatement::BindInt(int parameter, int64_t value) {
  sqlite3_bind_int64(statement_, parameter, value);
  return *this;
}

SqliteStatement& SqliteStatement::BindText(int parameter, absl::string_view value) {
  sqlite3_bind_text64(statement_, parameter, value.data(), value.size(), SQLITE_STATIC,
                      SQLITE_UTF8);
  return *this;
}

SqliteStatement& SqliteStatement::BindBlob(int parameter, absl::string_view value) {
  // A null pointer would bind NULL.
  const char* data = value.data() == nullptr ? "" : value.data();
  sqlite3_bind_blob64(statement_, parameter, data, value.size(), SQLITE_STATIC);
  return *this;
}

SqliteStatement& SqliteStatement::BindNull(int parameter) {
  sqlite3_bind_null(statement_, parameter);
  return *this;
}

absl::StatusOr<bool> SqliteStatement::Step() {
  const int result = sqlite3_step(statement_);
  if (result == SQLITE_ROW) return true;
  if (result == SQLITE_DONE) return false;
  sqlite3* database = sqlite3_db_handle(statement_);
  absl::Status status = SqliteError(result, sqlite3_errmsg(database));
  sqlite3_reset(statement_);
  return status;
}

int64_t SqliteStatement::Int(int column) const { return sqlite3_column_int64(statement_, column); }

absl::string_view SqliteStatement::Bytes(int column) const {
  const void* data = sqlite3_column_blob(statement_, column);
  const int size = sqlite3_column_bytes(statement_, column);
  return data == nullptr ? absl::string_view()
                         : absl::string_view(static_cast<const char*>(data), size);
}

bool SqliteStatement::IsNull(int column) const {
  return sqlite3_column_type(statement_, column) == SQLITE_NULL;
}

void SqliteStatement::Reset() {
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
}

absl::Status SqliteStatement::Run() {
  return ForEach([](const SqliteStatement&) { return absl::OkStatus(); });
}

absl::Status SqliteStatement::ForEach(
    const std::function<absl::Status(const SqliteStatement& row)>& read) {
  absl::Status status;
  while (status.ok()) {
    const absl::StatusOr<bool> row = Step();
    status = row.status();
    if (!row.ok() || !*row) break;
    status = read(*this);
  }
  Reset();
  return status;
}

absl::StatusOr<std::unique_ptr<SqliteDatabase>> SqliteDatabase::Open(const std::string& path,
                                                                     Mode mode,
                                                                     const std::string& vfs) {
  sqlite3* handle = nullptr;
  const int flags = FlagsOf(mode) | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_EXRESCODE;
  const int result =
      sqlite3_open_v2(path.c_str(), &handle, flags, vfs.empty() ? nullptr : vfs.c_str());
  std::unique_ptr<SqliteDatabase> database(new SqliteDatabase(handle));
  if (result != SQLITE_OK) {
    return SqliteError(result, absl::StrCat(path, ": ", sqlite3_errstr(result)));
  }
  database->SetBusyTimeout(kBusyTimeoutMs);
  return database;
}

SqliteDatabase::~SqliteDatabase() { sqlite3_close_v2(database_); }

absl::Status SqliteDatabase::Execute(const std::string& sql) {
  const int result = sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr);
  if (result == SQLITE_OK) return absl::OkStatus();
  return SqliteError(result, sqlite3_errmsg(database_));
}

absl::StatusOr<SqliteStatement> SqliteDatabase::Prepare(absl::string_view sql) {
  sqlite3_stmt* statement = nullptr;
  const int result = sqlite3_prepare_v3(database_, sql.data(), static_cast<int>(sql.size()),
                                        SQLITE_PREPARE_PERSISTENT, &statement, nullptr);
  if (result != SQLITE_OK) return SqliteError(result, sqlite3_errmsg(database_));
  return SqliteStatement(statement);
}

absl::StatusOr<int64_t> SqliteDatabase::QueryInt(absl::string_view sql) {
  ASSIGN_OR_RETURN(SqliteStatement statement, Prepare(sql));
  ASSIGN_OR_RETURN(const bool row, statement.Step());
  if (!row) return absl::NotFoundError("database: no row");
  return statement.Int(0);
}

void SqliteDatabase::SetBusyTimeout(int timeout_ms) {
  busy_timeout_ms_ = timeout_ms;
  sqlite3_busy_timeout(database_, timeout_ms);
}

absl::Status SqliteDatabase::Checkpoint(Checkpointing how) {
  const bool truncate = how == Checkpointing::kTruncate;
  int in_log = 0;
  int moved = 0;
  sqlite3_busy_timeout(database_, 0);
  const int result = sqlite3_wal_checkpoint_v2(
      database_, "main", truncate ? SQLITE_CHECKPOINT_TRUNCATE : SQLITE_CHECKPOINT_PASSIVE, &in_log,
      &moved);
  sqlite3_busy_timeout(database_, busy_timeout_ms_);
  if (result != SQLITE_OK) return SqliteError(result, sqlite3_errmsg(database_));
  if (in_log == moved) wal_pages_ = 0;
  return absl::OkStatus();
}

void SqliteDatabase::CountWalPages() {
  sqlite3_wal_hook(
      database_,
      [](void* database, sqlite3*, const char*, int pages) {
        static_cast<SqliteDatabase*>(database)->wal_pages_ = pages;
        return SQLITE_OK;
      },
      this);
}

bool SqliteDatabase::InAutocommit() const { return sqlite3_get_autocommit(database_) != 0; }

absl::StatusOr<SqliteTransaction> SqliteTransaction::Begin(SqliteDatabase* database) {
  RETURN_IF_ERROR(database->Execute("BEGIN IMMEDIATE"));
  return SqliteTransaction(database);
}

SqliteTransaction::SqliteTransaction(SqliteTransaction&& other) noexcept
    : database_(std::exchange(other.database_, nullptr)) {}

SqliteTransaction::~SqliteTransaction() {
  // After some errors SQLite has rolled back by itself; what cannot be rolled back was not stored.
  if (database_ != nullptr && !database_->InAutocommit()) {
    database_->Execute("ROLLBACK").IgnoreError();
  }
}

absl::Status SqliteTransaction::Commit() {
  RETURN_IF_ERROR(database_->Execute("COMMIT"));
  database_ = nullptr;
  return absl::OkStatus();
}

}  // namespace overtone
