// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_SALVAGE_IMPORT_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_SALVAGE_IMPORT_H_

#include <map>
#include <set>
#include <string>

#include "absl/status/status.h"
#include "overtone/services/mapping_server/submap_store/raw_pages.h"
#include "overtone/services/mapping_server/submap_store/store_tables.h"

namespace overtone {

// Takes what looks like rows and stores those that prove what they are: by their checksums, not by
// the table they were in. Of several for one place the last one in the store's life wins.
class SalvageImport {
 public:
  // An empty, prepared store in a transaction of the caller's.
  explicit SalvageImport(StoreTables* tables) : tables_(*tables) {}

  absl::Status Take(const RawRow& row);
  // Writes what was only collected.
  absl::Status Finish();

 private:
  absl::Status TakeLog(const RawRow& row);
  absl::Status TakeBlob(const RawRow& row);
  void TakeState(const RawRow& row);
  void TakeMission(const RawRow& row);
  void TakeAbandoned(const RawRow& row);
  void TakeSnapshot(const RawRow& row);

  StoreTables& tables_;
  std::map<int64_t, int> log_;  // position: how good the row is that we have
  std::set<std::string> blobs_;
  StateRow state_;
  std::map<MissionId, int64_t> missions_;  // next sequence
  std::set<std::pair<MissionId, std::string>> abandoned_;
  std::set<std::string> damaged_;
  int64_t snapshot_us_ = -1;
  std::string snapshot_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_SALVAGE_IMPORT_H_
