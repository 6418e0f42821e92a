// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/append_operations.h"

#include "absl/time/clock.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/sha256.h"

namespace overtone {
namespace {

std::vector<MissionId> EndsOf(const LoopClosure& closure) {
  std::vector<MissionId> ends = {closure.from.mission};
  if (closure.to.mission != closure.from.mission) ends.push_back(closure.to.mission);
  return ends;
}

LogRow Entry(LogKind kind, const std::vector<MissionId>& missions, const std::string& digest,
             const std::string& bytes) {
  LogRow row;
  row.kind = kind;
  row.stored_us = absl::ToUnixMicros(absl::Now());
  row.about = AboutMissions(missions);
  row.digest = digest;
  row.bytes = bytes;
  return row;
}

}  // namespace

absl::Status AppendSubmap::Write(BatchPlan& plan, StoreTables& tables) {
  added_ = plan.AdmitSubmap(record_);
  if (!added_.ok() || !*added_) return absl::OkStatus();
  LogRow row = Entry(LogKind::kSubmap, {record_.mission}, record_.digest, record_.bytes);
  row.position = plan.NextPosition();
  row.sequence = record_.submap->sequence;
  stored_at_ = absl::FromUnixMicros(row.stored_us);
  plan.Changed();
  RETURN_IF_ERROR(tables.PutLog(row));
  return tables.PutMission({plan.RowOf(record_.mission), record_.mission, row.sequence + 1});
}

void AppendSubmap::Publish(StoreIndex& index, SinkCalls& calls) {
  if (added_.ok() && *added_) {
    const std::vector<KeyframeCloud> there = index.AddSubmap(record_, stored_at_);
    calls.push_back([mission = record_.mission, submap = record_.submap](
                        const SubmapStore::Sink& sink) { sink.on_submap(mission, submap); });
    for (const KeyframeCloud& cloud : there) {
      calls.push_back([mission = record_.mission, cloud](const SubmapStore::Sink& sink) {
        sink.on_cloud(mission, cloud.index, cloud.sha256);
      });
    }
  }
  state_ = index.State(record_.mission);
}

void AppendSubmap::Finish(const absl::Status& batch) {
  if (!batch.ok()) {
    done_(batch);
  } else if (!added_.ok()) {
    done_(added_.status());
  } else {
    done_(AppendResult{*added_, state_});
  }
}

std::string AppendClosures::lane() const {
  return records_.empty() ? "" : records_.front().closure.from.mission.robot;
}

int64_t AppendClosures::bytes() const {
  int64_t bytes = 0;
  for (const LoopClosureRecord& record : records_) bytes += record.bytes.size();
  return bytes;
}

absl::Status AppendClosures::Write(BatchPlan& plan, StoreTables& tables) {
  added_.clear();
  admitted_ = plan.AdmitClosures(records_.size());
  if (!admitted_.ok()) return absl::OkStatus();
  for (const LoopClosureRecord& record : records_) {
    if (!plan.AdmitClosure(record.digest)) continue;
    added_.push_back(&record);
    LogRow row = Entry(LogKind::kLoopClosure, EndsOf(record.closure), record.digest, record.bytes);
    row.position = plan.NextPosition();
    plan.Changed();
    RETURN_IF_ERROR(tables.PutLog(row));
  }
  return absl::OkStatus();
}

void AppendClosures::Publish(StoreIndex& index, SinkCalls& calls) {
  for (const LoopClosureRecord* record : added_) {
    index.AddClosure(record->digest);
    calls.push_back([closure = record->closure](const SubmapStore::Sink& sink) {
      sink.on_loop_closure(closure);
    });
  }
}

void AppendClosures::Finish(const absl::Status& batch) {
  if (!batch.ok()) {
    done_(batch);
  } else if (!admitted_.ok()) {
    done_(admitted_);
  } else {
    done_(static_cast<int>(added_.size()));
  }
}

absl::Status AppendFinding::Write(BatchPlan& plan, StoreTables& tables) {
  LogRow row = Entry(LogKind::kFinding, record_.missions, Sha256(record_.bytes), record_.bytes);
  row.position = plan.NextPosition();
  plan.Changed();
  return tables.PutLog(row);
}

void AppendFinding::Publish(StoreIndex&, SinkCalls& calls) {
  calls.push_back(
      [bytes = record_.bytes](const SubmapStore::Sink& sink) { sink.on_finding(bytes); });
}

}  // namespace overtone
