// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/store_rows.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "overtone/proto/conversion/sha256.h"

namespace overtone {
namespace {

constexpr size_t kChecksumBytes = 16;

// The table's name first, so that a row of one table is none of another; texts behind their length.
class Hashed {
 public:
  explicit Hashed(absl::string_view table) { Text(table); }
  Hashed& Int(int64_t value) {
    absl::StrAppend(&fields_, value, ",");
    return *this;
  }
  Hashed& Text(absl::string_view value) {
    absl::StrAppend(&fields_, value.size(), ":", value);
    return *this;
  }
  std::string Sum() const { return Sha256(fields_).substr(0, kChecksumBytes); }

 private:
  std::string fields_;
};

}  // namespace

std::string FormatChecksum(int64_t version) { return Hashed("format").Int(version).Sum(); }

std::string Checksum(const LogRow& row) {
  return Hashed("log")
      .Int(row.position)
      .Int(static_cast<int64_t>(row.kind))
      .Int(row.sequence)
      .Int(row.stored_us)
      .Text(row.about)
      .Text(row.digest)
      .Sum();
}

std::string Checksum(const StateRow& row) {
  return Hashed("state").Text(row.store_id).Int(row.log_end).Int(row.commits).Sum();
}

std::string Checksum(const MissionRow& row) {
  return Hashed("missions").Int(row.id).Text(ToString(row.mission)).Int(row.next_sequence).Sum();
}

std::string Checksum(const AbandonedRow& row) {
  return Hashed("abandoned").Int(row.id).Text(ToString(row.mission)).Text(row.sha256).Sum();
}

RowDamage DamageOf(const LogRow& row, absl::string_view checksum) {
  if (Checksum(row) != checksum) return RowDamage::kHeader;
  return Sha256(row.bytes) == row.digest ? RowDamage::kNone : RowDamage::kBytes;
}

LogRow EmptyRow(int64_t position, LogKind kind) {
  LogRow row;
  row.position = position;
  row.kind = kind;
  row.digest = Sha256("");
  return row;
}

std::string AboutMissions(const std::vector<MissionId>& missions) {
  std::string about;
  for (const MissionId& mission : missions) {
    absl::StrAppend(&about, about.empty() ? "" : "\n", ToString(mission));
  }
  return about;
}

std::vector<MissionId> MissionsOf(absl::string_view about) {
  std::vector<MissionId> missions;
  for (const absl::string_view line : absl::StrSplit(about, '\n', absl::SkipEmpty())) {
    const std::vector<std::string> parts = absl::StrSplit(line, absl::MaxSplits('/', 1));
    if (parts.size() == 2) missions.push_back({parts[0], parts[1]});
  }
  return missions;
}

}  // namespace overtone
