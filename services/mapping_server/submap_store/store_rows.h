// SPDX-License-Identifier: Apache-2.0
// The rows of a store, and the checksums by which each of them shows that it is as it was written.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_ROWS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_ROWS_H_

#include <cstdint>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "overtone/core/common/ids.h"

namespace overtone {

enum class LogKind : int64_t {
  kDeleted = 0,  // with its mission
  kSubmap = 1,
  kLoopClosure = 2,
  kFinding = 3,
  kLost = 4,  // to damage
};

struct LogRow {
  int64_t position = 0;
  LogKind kind = LogKind::kDeleted;
  int64_t sequence = 0;   // of a submap
  int64_t stored_us = 0;  // since 1970
  std::string about;      // missions, as AboutMissions writes them
  std::string digest;     // SHA-256 of `bytes`
  std::string bytes;
};

enum class RowDamage {
  kNone,
  kBytes,   // what the row says of itself is right, its bytes are not
  kHeader,  // nothing of it can be believed
};

struct StateRow {
  std::string store_id;  // 16 bytes at random: tells a file from its restored backup
  int64_t log_end = 0;   // the last position that was given
  int64_t commits = 0;
};

struct MissionRow {
  int64_t id = 0;
  MissionId mission;
  int64_t next_sequence = 0;
};

struct AbandonedRow {
  int64_t id = 0;
  MissionId mission;
  std::string sha256;
};

// Of all columns but themselves (and `bytes`, which the digest covers): 16 bytes of SHA-256.
std::string FormatChecksum(int64_t version);
std::string Checksum(const LogRow& row);
std::string Checksum(const StateRow& row);
std::string Checksum(const MissionRow& row);
std::string Checksum(const AbandonedRow& row);

RowDamage DamageOf(const LogRow& row, absl::string_view checksum);

// An empty row in the place of one that was deleted or lost.
LogRow EmptyRow(int64_t position, LogKind kind);

// "robot/mission", one a line.
std::string AboutMissions(const std::vector<MissionId>& missions);
std::vector<MissionId> MissionsOf(absl::string_view about);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_ROWS_H_
