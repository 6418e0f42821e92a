// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/log_entry.h"

#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_replace.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/v1/submap.pb.h"

namespace overtone {

absl::StatusOr<SubmapRecord> DecodeSubmap(const LogRow& row) {
  std::vector<MissionId> missions = MissionsOf(row.about);
  v1::Submap message;
  if (missions.size() != 1 || !message.ParseFromString(row.bytes)) {
    return absl::DataLossError("it is no submap");
  }
  ASSIGN_OR_RETURN(Submap submap, FromProto(message, missions.front()));
  return SubmapRecord{std::move(missions.front()),
                      std::make_shared<const Submap>(std::move(submap)), row.bytes, row.digest};
}

absl::StatusOr<LoopClosure> DecodeClosure(const LogRow& row) {
  v1::LoopClosure message;
  if (!message.ParseFromString(row.bytes)) return absl::DataLossError("it is no loop closure");
  return FromProto(message);
}

std::string NameOf(const LogRow& row, RowDamage damage) {
  const std::string name = absl::StrCat("log entry ", row.position);
  const std::string about = absl::StrReplaceAll(row.about, {{"\n", " and "}});
  if (damage == RowDamage::kHeader) return name;
  switch (row.kind) {
    case LogKind::kSubmap:
      return absl::StrCat(name, ", submap ", row.sequence, " of ", about);
    case LogKind::kLoopClosure:
      return absl::StrCat(name, ", a loop closure of ", about);
    case LogKind::kFinding:
      return absl::StrCat(name, ", a finding about ", about.empty() ? "the map" : about);
    case LogKind::kDeleted:
    case LogKind::kLost:
      break;
  }
  return name;
}

}  // namespace overtone
