// SPDX-License-Identifier: Apache-2.0
// One connection to a store's file and the statements on its tables. Rows in, rows out: what they
// mean is decided elsewhere.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_TABLES_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_TABLES_H_

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "overtone/core/storage/sqlite_database.h"
#include "overtone/services/mapping_server/submap_store/store_rows.h"

namespace overtone {

// Not thread-safe. Errors as in sqlite_database.h: DataLoss means that the file's structure is
// damaged; a damaged row is no error.
class StoreTables {
 public:
  // The file must be a prepared store (store_format.h) before a statement is used.
  static absl::StatusOr<std::unique_ptr<StoreTables>> Open(const std::string& path,
                                                           SqliteDatabase::Mode mode,
                                                           const std::string& vfs);

  SqliteDatabase& database() { return *database_; }

  // Any entry, blob or snapshot, and anything set aside.
  absl::StatusOr<bool> HasContent();

  // NotFound: not there or damaged.
  absl::StatusOr<StateRow> GetState();
  absl::Status PutState(const StateRow& row);

  using ReadLog = std::function<absl::Status(LogRow row, RowDamage damage)>;
  absl::Status PutLog(const LogRow& row);
  // By position, from `first` on.
  absl::Status ForEachLog(int64_t first, const ReadLog& read);
  // Without the bytes, which are not read from disk: no digest is checked.
  absl::Status ForEachLogHeader(const std::function<absl::Status(LogRow row)>& read);
  // NotFound: no such row.
  absl::Status ReadLogAt(int64_t position, const ReadLog& read);

  template <typename Row>
  using ReadRow = std::function<absl::Status(const Row& row, bool damaged)>;
  absl::Status PutMission(const MissionRow& row);
  absl::Status ForEachMission(const ReadRow<MissionRow>& read);
  absl::Status DeleteMission(int64_t id);
  absl::Status PutAbandoned(const AbandonedRow& row);
  absl::Status ForEachAbandoned(const ReadRow<AbandonedRow>& read);
  absl::Status DeleteAbandoned(int64_t id);

  absl::Status PutBlob(int64_t id, const std::string& sha256, absl::string_view bytes);
  struct StoredBlob {
    std::string sha256;
    std::string bytes;
  };
  absl::StatusOr<StoredBlob> GetBlob(int64_t id);  // unchecked; NotFound: no such row
  absl::Status DeleteBlob(int64_t id);
  // Without the bytes.
  absl::Status ForEachBlob(
      const std::function<absl::Status(int64_t id, const std::string& sha256, int64_t size)>& read);

  absl::Status PutSnapshot(int64_t stored_us, absl::string_view bytes);
  // NotFound: none. DataLoss: its checksum is wrong.
  absl::StatusOr<std::string> GetSnapshot();
  absl::Status DeleteSnapshot();

  absl::Status AddDamaged(int64_t found_us, absl::string_view what, absl::string_view bytes);
  absl::Status ForEachDamaged(const std::function<absl::Status(const std::string& what)>& read);

 private:
  explicit StoreTables(std::unique_ptr<SqliteDatabase> database) : database_(std::move(database)) {}

  // Prepared once. `sql` is a literal.
  absl::StatusOr<SqliteStatement*> Statement(absl::string_view sql);
  absl::Status DeleteRow(absl::string_view sql, int64_t id);

  std::unique_ptr<SqliteDatabase> database_;
  std::map<absl::string_view, SqliteStatement> statements_;  // destroyed first
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_TABLES_H_
