// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/maintenance_operations.h"

#include <algorithm>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/services/mapping_server/submap_store/log_entry.h"

namespace overtone {
namespace {

// 2 MiB: what a neighbour's acknowledgement may have to wait for.
constexpr int kPagesPerVacuum = 512;

bool IsAbout(const LogRow& row, const MissionId& mission) {
  const std::vector<MissionId> missions = MissionsOf(row.about);
  return std::find(missions.begin(), missions.end(), mission) != missions.end();
}

}  // namespace

absl::Status DeleteMissionOperation::Write(BatchPlan& plan, StoreTables& tables) {
  submap_closures_ = 0;
  sha256s_.clear();
  closures_.clear();
  found_ = plan.index().HasMission(mission_)
               ? absl::OkStatus()
               : absl::NotFoundError(absl::StrCat("mission: there is no ", ToString(mission_)));
  if (!found_.ok()) return absl::OkStatus();
  plan.Changed();
  RETURN_IF_ERROR(EmptyLog(tables));
  RETURN_IF_ERROR(DeleteAbandoned(tables));
  for (const auto& [sha256, blob] : plan.index().SoleBlobs(sha256s_)) {
    RETURN_IF_ERROR(tables.DeleteBlob(blob.id));
  }
  RETURN_IF_ERROR(tables.DeleteMission(plan.RowOf(mission_)));
  plan.ForgetRowOf(mission_);
  return tables.DeleteSnapshot();
}

absl::Status DeleteMissionOperation::EmptyLog(StoreTables& tables) {
  std::vector<LogRow> rows;
  RETURN_IF_ERROR(tables.ForEachLogHeader([&](LogRow row) {
    if (IsAbout(row, mission_)) rows.push_back(std::move(row));
    return absl::OkStatus();
  }));
  // What hangs in the air after a lost submap has brought no clouds into the index.
  for (const LogRow& row : rows) {
    if (row.kind == LogKind::kLoopClosure) closures_.push_back(row.digest);
    if (row.kind == LogKind::kSubmap) RETURN_IF_ERROR(TakeClouds(tables, row.position));
    RETURN_IF_ERROR(tables.PutLog(EmptyRow(row.position, LogKind::kDeleted)));
  }
  return absl::OkStatus();
}

absl::Status DeleteMissionOperation::TakeClouds(StoreTables& tables, int64_t position) {
  return tables.ReadLogAt(position, [&](const LogRow& row, RowDamage damage) {
    const absl::StatusOr<SubmapRecord> record = DecodeSubmap(row);
    if (damage != RowDamage::kNone || !record.ok()) return absl::OkStatus();
    submap_closures_ += static_cast<int64_t>(record->submap->loop_closures.size());
    for (const KeyframeCloud& cloud : record->submap->clouds) sha256s_.push_back(cloud.sha256);
    return absl::OkStatus();
  });
}

absl::Status DeleteMissionOperation::DeleteAbandoned(StoreTables& tables) {
  std::vector<int64_t> ids;
  RETURN_IF_ERROR(tables.ForEachAbandoned([&](const AbandonedRow& row, bool) {
    if (row.mission == mission_) ids.push_back(row.id);
    return absl::OkStatus();
  }));
  for (const int64_t id : ids) RETURN_IF_ERROR(tables.DeleteAbandoned(id));
  return absl::OkStatus();
}

void DeleteMissionOperation::Publish(StoreIndex& index, SinkCalls&) {
  if (found_.ok()) index.DropMission(mission_, submap_closures_, sha256s_, closures_);
}

absl::Status VacuumOperation::Write(BatchPlan& plan, StoreTables& tables) {
  plan.Changed();
  RETURN_IF_ERROR(
      tables.database().Execute(absl::StrCat("PRAGMA incremental_vacuum(", kPagesPerVacuum, ")")));
  ASSIGN_OR_RETURN(left_, tables.database().QueryInt("PRAGMA freelist_count"));
  return absl::OkStatus();
}

void VacuumOperation::Finish(const absl::Status& batch) {
  if (batch.ok()) {
    done_(left_);
  } else {
    done_(batch);
  }
}

absl::Status LoseBlobOperation::Write(BatchPlan& plan, StoreTables& tables) {
  what_.clear();
  clouds_.clear();
  abandoned_by_.clear();
  const absl::optional<IndexedBlob> indexed = plan.index().FindBlob(sha256_);
  if (!indexed.has_value()) return absl::OkStatus();
  absl::StatusOr<StoreTables::StoredBlob> blob = tables.GetBlob(indexed->id);
  if (absl::IsDataLoss(blob.status())) return blob.status();
  if (blob.ok() && Sha256(blob->bytes) == sha256_) return absl::OkStatus();
  RETURN_IF_ERROR(FindClouds(tables));
  what_ = absl::StrCat("cloud ", absl::BytesToHexString(sha256_),
                       blob.ok() ? ": damaged" : ": vanished", "; it is asked for again");
  plan.Changed();
  RETURN_IF_ERROR(
      tables.AddDamaged(absl::ToUnixMicros(absl::Now()), what_, blob.ok() ? blob->bytes : ""));
  return tables.DeleteBlob(indexed->id);
}

absl::Status LoseBlobOperation::FindClouds(StoreTables& tables) {
  RETURN_IF_ERROR(tables.ForEachLog(1, [&](const LogRow& row, RowDamage damage) {
    if (row.kind != LogKind::kSubmap || damage != RowDamage::kNone) return absl::OkStatus();
    const absl::StatusOr<SubmapRecord> record = DecodeSubmap(row);
    if (!record.ok()) return absl::OkStatus();
    for (const KeyframeCloud& cloud : record->submap->clouds) {
      if (cloud.sha256 == sha256_) clouds_.emplace_back(record->mission, cloud);
    }
    return absl::OkStatus();
  }));
  return tables.ForEachAbandoned([&](const AbandonedRow& row, bool damaged) {
    if (!damaged && row.sha256 == sha256_) abandoned_by_.push_back(row.mission);
    return absl::OkStatus();
  });
}

void LoseBlobOperation::Publish(StoreIndex& index, SinkCalls& calls) {
  if (what_.empty()) return;
  losses_->Add(what_);
  index.LoseBlob(sha256_, clouds_);
  for (const MissionId& mission : abandoned_by_) {
    for (const NodeId& keyframe : index.Abandon(mission, sha256_)) {
      calls.push_back([keyframe](const SubmapStore::Sink& sink) {
        sink.on_cloud_gone(keyframe.mission, keyframe.index);
      });
    }
  }
}

}  // namespace overtone
