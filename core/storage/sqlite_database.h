// SPDX-License-Identifier: Apache-2.0
// SQLite (https://sqlite.org) with this project's errors: the one place that calls it for plain
// storage work, on the robot and on the server.
#ifndef OVERTONE_CORE_STORAGE_SQLITE_DATABASE_H_
#define OVERTONE_CORE_STORAGE_SQLITE_DATABASE_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"

struct sqlite3;
struct sqlite3_stmt;

namespace overtone {

// Every failure of SQLite, with its own message:
//   ResourceExhausted   no space, an I/O error on writing: may work again later
//   DataLoss            the file is damaged, or is no database
//   Unavailable         locked by somebody else
//   NotFound            the file cannot be opened
//   AlreadyExists       a uniqueness constraint
//   Internal            a defect of ours
// A database and its statements are used by one thread at a time.
class SqliteStatement {
 public:
  SqliteStatement(SqliteStatement&& other) noexcept;
  SqliteStatement& operator=(SqliteStatement&& other) noexcept;
  ~SqliteStatement();

  // Parameters count from 1, columns from 0. What is bound by Blob or Text must live until the
  // statement is reset.
  SqliteStatement& BindInt(int parameter, int64_t value);
  SqliteStatement& BindText(int parameter, absl::string_view value);
  SqliteStatement& BindBlob(int parameter, absl::string_view value);
  SqliteStatement& BindNull(int parameter);

  // True: there is a row. False: done.
  absl::StatusOr<bool> Step();
  int64_t Int(int column) const;
  // Valid until the next Step or Reset.
  absl::string_view Bytes(int column) const;  // a blob or a text
  std::string String(int column) const { return std::string(Bytes(column)); }
  bool IsNull(int column) const;
  // Ready to be bound and stepped anew.
  void Reset();

  // Steps to the end, whatever rows there are, and resets.
  absl::Status Run();
  // `read` for each row, until the end or the first error; then resets.
  absl::Status ForEach(const std::function<absl::Status(const SqliteStatement& row)>& read);

 private:
  friend class SqliteDatabase;
  explicit SqliteStatement(sqlite3_stmt* statement) : statement_(statement) {}

  sqlite3_stmt* statement_;
};

class SqliteDatabase {
 public:
  enum class Mode { kReadOnly, kReadWrite, kCreate };

  // `vfs`: a registered one, or empty for the system's.
  static absl::StatusOr<std::unique_ptr<SqliteDatabase>> Open(const std::string& path, Mode mode,
                                                              const std::string& vfs = "");
  ~SqliteDatabase();

  SqliteDatabase(const SqliteDatabase&) = delete;
  SqliteDatabase& operator=(const SqliteDatabase&) = delete;

  // One or more statements without parameters; rows are ignored.
  absl::Status Execute(const std::string& sql);
  // One statement, to be used again and again. It must not outlive the database.
  absl::StatusOr<SqliteStatement> Prepare(absl::string_view sql);
  // The first column of the first row. NotFound: no row.
  absl::StatusOr<int64_t> QueryInt(absl::string_view sql);

  // False: inside a transaction.
  bool InAutocommit() const;
  // How long to wait for somebody else's lock; 5000 after Open.
  void SetBusyTimeout(int timeout_ms);

  // From the write-ahead log into the database, as far as readers allow. kTruncate: and makes the
  // log empty; Unavailable when a reader is in the way. Never waits.
  enum class Checkpointing { kPassive, kTruncate };
  absl::Status Checkpoint(Checkpointing how);
  // Pages in the write-ahead log after the last commit through this connection; 0 after a
  // checkpoint that got all of them. Replaces SQLite's automatic checkpoints.
  void CountWalPages();
  int wal_pages() const { return wal_pages_; }

  sqlite3* handle() { return database_; }

 private:
  explicit SqliteDatabase(sqlite3* database) : database_(database) {}

  sqlite3* database_;
  int wal_pages_ = 0;
  int busy_timeout_ms_ = 0;
};

// BEGIN IMMEDIATE … COMMIT; rolls back when it goes out of scope before Commit succeeded.
class SqliteTransaction {
 public:
  static absl::StatusOr<SqliteTransaction> Begin(SqliteDatabase* database);
  SqliteTransaction(SqliteTransaction&& other) noexcept;
  SqliteTransaction& operator=(SqliteTransaction&&) = delete;
  ~SqliteTransaction();

  // Not ok: nothing is stored.
  absl::Status Commit();

 private:
  explicit SqliteTransaction(SqliteDatabase* database) : database_(database) {}

  SqliteDatabase* database_;  // null: committed or moved from
};

// The last error of a connection (extended code `code`) as above.
absl::Status SqliteError(int code, absl::string_view message);

}  // namespace overtone

#endif  // OVERTONE_CORE_STORAGE_SQLITE_DATABASE_H_
