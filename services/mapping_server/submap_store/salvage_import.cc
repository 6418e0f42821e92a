// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/salvage_import.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/time/clock.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/services/mapping_server/submap_store/log_compression.h"

namespace overtone {
namespace {

using Type = RawValue::Type;

// The types of the columns behind the rowid, which SQLite stores as NULL.
bool HasTypes(const RawRow& row, const std::vector<Type>& types) {
  if (row.values.size() != types.size() + 1) return false;
  for (size_t i = 0; i < types.size(); ++i) {
    if (row.values[i + 1].type != types[i]) return false;
  }
  return true;
}

MissionId MissionOf(const RawValue& value) {
  std::vector<MissionId> missions = MissionsOf(value.bytes);
  return missions.size() == 1 ? std::move(missions.front()) : MissionId();
}

}  // namespace

absl::Status SalvageImport::Take(const RawRow& row) {
  if (HasTypes(row, {Type::kInteger, Type::kInteger, Type::kInteger, Type::kText, Type::kBlob,
                     Type::kBlob, Type::kInteger, Type::kBlob})) {
    return TakeLog(row);
  }
  if (HasTypes(row, {Type::kBlob, Type::kBlob})) return TakeBlob(row);
  if (HasTypes(row, {Type::kBlob, Type::kInteger, Type::kInteger, Type::kBlob})) TakeState(row);
  if (HasTypes(row, {Type::kText, Type::kInteger, Type::kBlob})) TakeMission(row);
  if (HasTypes(row, {Type::kText, Type::kBlob, Type::kBlob})) TakeAbandoned(row);
  if (HasTypes(row, {Type::kInteger, Type::kBlob, Type::kBlob})) TakeSnapshot(row);
  if (HasTypes(row, {Type::kInteger, Type::kText, Type::kBlob})) {
    damaged_.insert(row.values[2].bytes);
  }
  return absl::OkStatus();
}

absl::Status SalvageImport::TakeLog(const RawRow& row) {
  const std::vector<RawValue>& values = row.values;
  LogRow log;
  log.position = row.id;
  log.kind = static_cast<LogKind>(values[1].integer);
  log.sequence = values[2].integer;
  log.stored_us = values[3].integer;
  log.about = values[4].bytes;
  log.digest = values[5].bytes;
  log.bytes = DecodeLogBytes(static_cast<LogEncoding>(values[7].integer), values[8].bytes);
  const RowDamage damage = DamageOf(log, values[6].bytes);
  if (damage == RowDamage::kHeader) return absl::OkStatus();
  // What was deleted or lost stays so; a row without its bytes is better than none, because it says
  // whose it was: Replay sets it aside.
  const bool is_empty = log.kind == LogKind::kDeleted || log.kind == LogKind::kLost;
  const int worth = is_empty ? 3 : damage == RowDamage::kNone ? 2 : 1;
  int& had = log_[log.position];
  if (had >= worth) return absl::OkStatus();
  had = worth;
  return tables_.PutLog(log);
}

absl::Status SalvageImport::TakeBlob(const RawRow& row) {
  const std::string& sha256 = row.values[1].bytes;
  const std::string& bytes = row.values[2].bytes;
  if (Sha256(bytes) != sha256 || !blobs_.insert(sha256).second) return absl::OkStatus();
  return tables_.PutBlob(static_cast<int64_t>(blobs_.size()), sha256, bytes);
}

void SalvageImport::TakeState(const RawRow& row) {
  const StateRow state = {row.values[1].bytes, row.values[2].integer, row.values[3].integer};
  const bool whole = row.values[4].bytes == Checksum(state);
  if (whole && state.commits > state_.commits) state_ = state;
}

void SalvageImport::TakeMission(const RawRow& row) {
  const MissionRow mission = {row.id, MissionOf(row.values[1]), row.values[2].integer};
  if (row.values[3].bytes != Checksum(mission)) return;
  int64_t& next = missions_[mission.mission];
  next = std::max(next, mission.next_sequence);
}

void SalvageImport::TakeAbandoned(const RawRow& row) {
  const AbandonedRow abandoned = {row.id, MissionOf(row.values[1]), row.values[2].bytes};
  if (row.values[3].bytes != Checksum(abandoned)) return;
  abandoned_.emplace(abandoned.mission, abandoned.sha256);
}

void SalvageImport::TakeSnapshot(const RawRow& row) {
  if (row.values[1].integer <= snapshot_us_ || Sha256(row.values[3].bytes) != row.values[2].bytes) {
    return;
  }
  snapshot_us_ = row.values[1].integer;
  snapshot_ = row.values[3].bytes;
}

absl::Status SalvageImport::Finish() {
  if (state_.commits > 0) RETURN_IF_ERROR(tables_.PutState(state_));
  int64_t id = 0;
  for (const auto& [mission, next] : missions_) {
    RETURN_IF_ERROR(tables_.PutMission({++id, mission, next}));
  }
  id = 0;
  for (const auto& [mission, sha256] : abandoned_) {
    RETURN_IF_ERROR(tables_.PutAbandoned({++id, mission, sha256}));
  }
  for (const std::string& what : damaged_) {
    RETURN_IF_ERROR(tables_.AddDamaged(absl::ToUnixMicros(absl::Now()), what, ""));
  }
  if (snapshot_us_ >= 0) RETURN_IF_ERROR(tables_.PutSnapshot(snapshot_us_, snapshot_));
  return absl::OkStatus();
}

}  // namespace overtone
