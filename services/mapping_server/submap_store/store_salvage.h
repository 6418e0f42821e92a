// SPDX-License-Identifier: Apache-2.0
// When the structure of a store's file is damaged: what is left of it moves into a new file.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_SALVAGE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_SALVAGE_H_

#include <string>

#include "absl/status/status.h"
#include "overtone/core/storage/sqlite_database.h"
#include "overtone/services/mapping_server/submap_store/loss_list.h"

namespace overtone {

// Finishes a salvage that was interrupted. DataLoss: an empty file beside a write-ahead log, which
// SQLite would do away with.
absl::Status CheckBeforeOpening(const std::string& path);

// DataLoss: SQLite finds pages that do not fit together. Reads the whole file once.
absl::Status CheckStructure(SqliteDatabase* database);

// The file and its log are kept as `<path>.damaged-<UTC time>`, and a new store takes their place
// with every row that can be found in them and shows by its checksum that it is whole. Needs
// nothing of the file but its pages: no schema, no inner nodes. No connection may be open. An
// error: the disk is full or fails; then all is as before.
absl::Status SalvageStore(const std::string& path, const std::string& vfs, LossList* losses);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_SALVAGE_H_
