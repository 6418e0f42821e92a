// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_LOG_ENTRY_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_LOG_ENTRY_H_

#include <string>

#include "absl/status/statusor.h"
#include "overtone/services/mapping_server/submap_store.h"
#include "overtone/services/mapping_server/submap_store/store_rows.h"

namespace overtone {

// What a whole row holds. An error: the bytes are as they were stored, but this version cannot
// read them.
absl::StatusOr<SubmapRecord> DecodeSubmap(const LogRow& row);
absl::StatusOr<LoopClosure> DecodeClosure(const LogRow& row);

// "log entry 17, submap 3 of anna/run"; without more than its number when the row says nothing.
std::string NameOf(const LogRow& row, RowDamage damage);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_LOG_ENTRY_H_
