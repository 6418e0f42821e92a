// SPDX-License-Identifier: Apache-2.0
// What waits for the server, in one SQLite file for each mission.
#ifndef OVERTONE_CLIENT_INTERNAL_OUTBOX_FILE_H_
#define OVERTONE_CLIENT_INTERNAL_OUTBOX_FILE_H_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/client/internal/outbox_item.h"
#include "overtone/core/storage/sqlite_database.h"

namespace overtone {

// What Write has stored survives the end of the process, and after the next Sync the loss of power:
// the file is in WAL mode with synchronous=NORMAL, and a Sync is one small transaction with FULL,
// which flushes all that came before. The file is locked until this object goes or its process
// ends, however it ends. Not thread-safe. Errors are those of core/storage/sqlite_database.h.
class OutboxFile {
 public:
  // Opens the file, or makes an empty one. Unavailable: another process, or another client of this
  // one, has it open. DataLoss: damaged, or of a format that is not known.
  static absl::StatusOr<std::unique_ptr<OutboxFile>> Open(const std::string& path,
                                                          const std::string& vfs = "");

  // All items but their bytes. DataLoss: the file is damaged.
  absl::StatusOr<OutboxContent> Load();

  // All of it or nothing. Removing what is not there does no harm.
  absl::Status Write(const std::vector<int64_t>& removed_ids, const std::vector<OutboxItem>& added,
                     const OutboxPosition& position);

  absl::Status Sync();

  // DataLoss: the bytes are not those that were written. NotFound: there is no such item.
  absl::StatusOr<SharedBytes> Read(int64_t id);

  // Copies the items that can be read, in both directions from the ends, so that one damaged page
  // costs no more than what lies on it; and what is known of the position.
  OutboxContent Salvage(OutboxFile& target);

 private:
  explicit OutboxFile(std::unique_ptr<SqliteDatabase> database) : database_(std::move(database)) {}

  absl::Status Prepare();
  absl::Status CreateTables();
  absl::StatusOr<OutboxPosition> LoadPosition();
  absl::Status CopyItems(bool ascending, OutboxFile& target, OutboxContent& copied);

  // Before the statements, which it outlives.
  std::unique_ptr<SqliteDatabase> database_;
  std::unique_ptr<SqliteStatement> insert_, remove_, read_, set_position_;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_OUTBOX_FILE_H_
