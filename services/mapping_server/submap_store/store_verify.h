// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_VERIFY_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_VERIFY_H_

#include <string>

#include "absl/status/statusor.h"
#include "overtone/services/mapping_server/submap_store.h"
#include "overtone/services/mapping_server/submap_store/store_tables.h"

namespace overtone {

// Reads every row and checks it; changes nothing. What is damaged is in the report's losses, after
// what was lost before.
StoreReport VerifyTables(StoreTables& tables);

// Of a file that no store has open, such as a backup. NotFound: there is none. FailedPrecondition:
// written by a newer version. DataLoss: not a store, or its structure is damaged, so that a server
// would have to salvage it.
absl::StatusOr<StoreReport> VerifyStoreFile(const std::string& path);

// A consistent copy of an open store as a new file, on a connection of its own: one file, synced,
// without a log, with an identity of its own. AlreadyExists: `to` is there.
absl::Status BackUpStore(StoreTables& tables, const std::string& to);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_VERIFY_H_
