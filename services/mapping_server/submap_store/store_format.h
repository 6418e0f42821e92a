// SPDX-License-Identifier: Apache-2.0
// The tables of a map's store and how an older file becomes one of today.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_FORMAT_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_FORMAT_H_

#include "absl/status/status.h"
#include "overtone/core/storage/sqlite_database.h"

namespace overtone {

// "OVRS", where file(1) and SQLite look for it.
constexpr int kStoreApplicationId = 0x4f565253;
// Goes up with every migration in store_format.cc.
constexpr int kStoreFormatVersion = 1;

// How a connection to a store behaves: write-ahead log, every commit synced, no trust in the file.
absl::Status ConfigureConnection(SqliteDatabase* database);

// Makes the tables in an empty database, or brings those of an earlier version up to date, each
// migration in a transaction of its own.
//   FailedPrecondition   written by a newer version; untouched
//   DataLoss             not a store, or its schema is damaged
absl::Status PrepareStore(SqliteDatabase* database);
// As PrepareStore, for a file that must not be written.
absl::Status CheckStoreFormat(SqliteDatabase* database);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_FORMAT_H_
