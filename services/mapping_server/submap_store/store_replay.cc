// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/store_replay.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "openssl/rand.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/services/mapping_server/submap_store/log_entry.h"
#include "overtone/services/mapping_server/upload_rules.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

constexpr size_t kSha256Bytes = 32;

std::string NewStoreId() {
  std::string id(16, '\0');
  RAND_bytes(reinterpret_cast<unsigned char*>(id.data()), static_cast<int>(id.size()));
  return id;
}

}  // namespace

absl::Status StoreReplay::Run(const absl::optional<StateRow>& mark, int64_t told_until) {
  told_ = told_until;
  RETURN_IF_ERROR(tables_->ForEachDamaged([this](const std::string& what) {
    losses_->Remember(what);
    return absl::OkStatus();
  }));
  RETURN_IF_ERROR(ReadState(mark));
  RETURN_IF_ERROR(ReadBlobs());
  RETURN_IF_ERROR(ReadLog());
  RETURN_IF_ERROR(ReadMissions());
  RETURN_IF_ERROR(ReadAbandoned());
  RETURN_IF_ERROR(CheckOrphans());
  RETURN_IF_ERROR(MakeRepairs());
  TellClouds();
  return absl::OkStatus();
}

absl::Status StoreReplay::ReadState(const absl::optional<StateRow>& mark) {
  absl::StatusOr<StateRow> state = tables_->GetState();
  if (!state.ok() && !absl::IsNotFound(state.status())) return state.status();
  if (state.ok()) {
    state_ = *state;
    counters_.log_end = state_.log_end;
  } else {
    ASSIGN_OR_RETURN(const int64_t entries,
                     tables_->database().QueryInt("SELECT count(*) FROM log"));
    state_.store_id = mark.has_value() ? mark->store_id : NewStoreId();
    if (entries > 0 || mark.has_value()) {
      SetAside("the count of log entries is damaged: the last ones may be lost", "", nullptr);
    }
  }
  if (!mark.has_value() || mark->store_id != state_.store_id || mark->commits <= state_.commits) {
    return absl::OkStatus();
  }
  SetAside(absl::StrCat("the last ", mark->commits - state_.commits,
                        " commits are lost, with log entries after ", state_.log_end, " up to ",
                        mark->log_end, " and clouds, which are asked for again"),
           "", nullptr);
  state_.commits = mark->commits;
  counters_.log_end = std::max(counters_.log_end, mark->log_end);
  return absl::OkStatus();
}

absl::Status StoreReplay::ReadBlobs() {
  return tables_->ForEachBlob([this](int64_t id, const std::string& sha256, int64_t size) {
    counters_.blob_id = std::max(counters_.blob_id, id);
    if (sha256.size() == kSha256Bytes && !index_->FindBlob(sha256).has_value()) {
      index_->AddBlob(sha256, id, size);
    } else {
      SetAside(absl::StrCat("cloud ", id, ": its name is damaged"), "",
               [id](StoreTables& tables) { return tables.DeleteBlob(id); });
    }
    return absl::OkStatus();
  });
}

absl::Status StoreReplay::ReadLog() {
  int64_t expected = 1;
  RETURN_IF_ERROR(tables_->ForEachLog(1, [&](const LogRow& row, RowDamage damage) {
    if (row.position > expected) MissEntries(expected, row.position - 1);
    expected = row.position + 1;
    TakeEntry(row, damage);
    told_ = std::max(told_, row.position);
    return absl::OkStatus();
  }));
  if (expected <= counters_.log_end) MissEntries(expected, counters_.log_end);
  counters_.log_end = std::max(counters_.log_end, expected - 1);
  return absl::OkStatus();
}

void StoreReplay::TakeEntry(const LogRow& row, RowDamage damage) {
  if (damage != RowDamage::kNone) {
    const bool of_mission = damage == RowDamage::kBytes && row.kind == LogKind::kSubmap;
    for (const MissionId& mission : MissionsOf(of_mission ? row.about : "")) {
      index_->MarkLost(mission);
    }
    return SetAside(absl::StrCat(NameOf(row, damage), ": damaged"), row.bytes,
                    [position = row.position](StoreTables& tables) {
                      return tables.PutLog(EmptyRow(position, LogKind::kLost));
                    });
  }
  const bool is_news = sink_ != nullptr && row.position > told_;
  absl::Status status;
  if (row.kind == LogKind::kSubmap) status = TakeSubmap(row);
  if (row.kind == LogKind::kLoopClosure) status = TakeClosure(row);
  if (row.kind == LogKind::kFinding && is_news) sink_->on_finding(row.bytes);
  // Whole, but this version cannot use it: it stays where it is.
  if (!status.ok()) {
    losses_->Add(absl::StrCat(NameOf(row, damage), ": cannot be used: ", status.message()));
  }
}

absl::Status StoreReplay::TakeSubmap(const LogRow& row) {
  const std::vector<MissionId> missions = MissionsOf(row.about);
  absl::StatusOr<SubmapRecord> record = DecodeSubmap(row);
  absl::Status status = record.status();
  if (status.ok() && index_->IsLost(record->mission)) {
    status = absl::DataLossError("an earlier submap of its mission is lost");
  }
  if (status.ok()) status = CheckContinues(index_->State(record->mission), *record->submap);
  if (!status.ok()) {
    for (const MissionId& mission : missions) index_->MarkLost(mission);
    return status;
  }
  for (const KeyframeCloud& cloud :
       index_->AddSubmap(*record, absl::FromUnixMicros(row.stored_us))) {
    clouds_[record->mission][cloud.index] = cloud.sha256;
  }
  if (sink_ != nullptr && row.position > told_) sink_->on_submap(record->mission, record->submap);
  return absl::OkStatus();
}

absl::Status StoreReplay::TakeClosure(const LogRow& row) {
  index_->AddClosure(row.digest);
  ASSIGN_OR_RETURN(const LoopClosure closure, DecodeClosure(row));
  if (sink_ != nullptr && row.position > told_) sink_->on_loop_closure(closure);
  return absl::OkStatus();
}

void StoreReplay::MissEntries(int64_t first, int64_t last) {
  const std::string what = first == last
                               ? absl::StrCat("log entry ", first, ": vanished")
                               : absl::StrCat("log entries ", first, " to ", last, ": vanished");
  SetAside(what, "", [first, last](StoreTables& tables) {
    for (int64_t position = first; position <= last; ++position) {
      RETURN_IF_ERROR(tables.PutLog(EmptyRow(position, LogKind::kLost)));
    }
    return absl::OkStatus();
  });
}

absl::Status StoreReplay::ReadMissions() {
  RETURN_IF_ERROR(tables_->ForEachMission([this](const MissionRow& row, bool damaged) {
    counters_.mission_id = std::max(counters_.mission_id, row.id);
    if (damaged) {
      SetAside(absl::StrCat("mission entry ", row.id, ": damaged, made anew from the log"), "",
               [id = row.id](StoreTables& tables) { return tables.DeleteMission(id); });
      return absl::OkStatus();
    }
    counters_.mission_ids[row.mission] = row.id;
    if (index_->State(row.mission).next_sequence < row.next_sequence) index_->MarkLost(row.mission);
    return absl::OkStatus();
  }));
  for (const auto& [mission, state] : index_->Missions()) {
    if (index_->IsLost(mission)) {
      losses_->Add(absl::StrCat("mission ", ToString(mission), ": its submaps from ",
                                state.next_sequence, " on are lost; it takes no more"));
    }
    const auto [row, is_new] = counters_.mission_ids.emplace(mission, counters_.mission_id + 1);
    if (!is_new) continue;
    ++counters_.mission_id;
    // One further than there is when it lost some: so that it stays known.
    const int64_t next = state.next_sequence + (index_->IsLost(mission) ? 1 : 0);
    repairs_.push_back([mission_row = MissionRow{row->second, mission, next}](StoreTables& tables) {
      return tables.PutMission(mission_row);
    });
  }
  return absl::OkStatus();
}

absl::Status StoreReplay::ReadAbandoned() {
  return tables_->ForEachAbandoned([this](const AbandonedRow& row, bool damaged) {
    counters_.abandoned_id = std::max(counters_.abandoned_id, row.id);
    if (damaged) {
      SetAside(absl::StrCat("abandoned cloud ", row.id, ": damaged, it is asked for again"), "",
               [id = row.id](StoreTables& tables) { return tables.DeleteAbandoned(id); });
      return absl::OkStatus();
    }
    for (const NodeId& keyframe : index_->Abandon(row.mission, row.sha256)) {
      clouds_[keyframe.mission][keyframe.index] = "";
    }
    return absl::OkStatus();
  });
}

// A blob whose submaps are lost, or one that has lost its name.
absl::Status StoreReplay::CheckOrphans() {
  for (const auto& [sha256, orphan] : index_->Orphans()) {
    absl::StatusOr<StoreTables::StoredBlob> blob = tables_->GetBlob(orphan.id);
    if (absl::IsDataLoss(blob.status())) return blob.status();
    const bool whole = blob.ok() && Sha256(blob->bytes) == sha256;
    SetAside(absl::StrCat("cloud ", orphan.id, whole ? ": its submap is lost" : ": damaged"),
             blob.ok() && !whole ? std::move(blob->bytes) : "",
             [id = orphan.id](StoreTables& tables) { return tables.DeleteBlob(id); });
    index_->DropBlob(sha256);
  }
  return absl::OkStatus();
}

void StoreReplay::TellClouds() {
  if (sink_ == nullptr) return;
  for (const auto& [mission, clouds] : clouds_) {
    for (const auto& [index, sha256] : clouds) {
      if (sha256.empty()) {
        sink_->on_cloud_gone(mission, index);
      } else {
        sink_->on_cloud(mission, index, sha256);
      }
    }
  }
}

void StoreReplay::SetAside(const std::string& what, std::string bytes, Repair repair) {
  losses_->Add(what);
  repairs_.push_back([what, bytes = std::move(bytes),
                      repair = std::move(repair)](StoreTables& tables) -> absl::Status {
    RETURN_IF_ERROR(tables.AddDamaged(absl::ToUnixMicros(absl::Now()), what, bytes));
    return repair == nullptr ? absl::OkStatus() : repair(tables);
  });
}

absl::Status StoreReplay::MakeRepairs() {
  state_.log_end = counters_.log_end;
  if (repairs_.empty()) return absl::OkStatus();
  ASSIGN_OR_RETURN(SqliteTransaction transaction, SqliteTransaction::Begin(&tables_->database()));
  absl::Status status;
  for (const Repair& repair : repairs_) {
    if (status.ok()) status = repair(*tables_);
  }
  ++state_.commits;
  if (status.ok()) status = tables_->PutState(state_);
  if (status.ok()) status = transaction.Commit();
  if (absl::IsDataLoss(status)) return status;
  // The damage is found again at the next start.
  if (!status.ok())
    spdlog::warn("store: what is damaged stays in place: {}", std::string(status.message()));
  return absl::OkStatus();
}

}  // namespace overtone
