// SPDX-License-Identifier: Apache-2.0
// From the file to the index and the sink: what a store holds, row by row, each checked; what is
// damaged is set aside and named.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_REPLAY_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_REPLAY_H_

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/types/optional.h"
#include "overtone/services/mapping_server/submap_store.h"
#include "overtone/services/mapping_server/submap_store/batch_plan.h"
#include "overtone/services/mapping_server/submap_store/loss_list.h"
#include "overtone/services/mapping_server/submap_store/store_index.h"
#include "overtone/services/mapping_server/submap_store/store_tables.h"

namespace overtone {

class StoreReplay {
 public:
  // `index` is empty. `sink`: nobody is told when it is null.
  StoreReplay(StoreTables* tables, StoreIndex* index, const SubmapStore::Sink* sink,
              LossList* losses)
      : tables_(tables), index_(index), sink_(sink), losses_(losses) {}

  // Log entries up to `told_until` were told by an earlier run that hit a damaged page. `mark`: how
  // far the store had come when it was last open. DataLoss: the file's structure is damaged.
  absl::Status Run(const absl::optional<StateRow>& mark, int64_t told_until);

  int64_t told() const { return told_; }  // the last log entry that the sink knows
  const StoreCounters& counters() const { return counters_; }
  const StateRow& state() const { return state_; }

 private:
  using Repair = std::function<absl::Status(StoreTables& tables)>;

  absl::Status ReadState(const absl::optional<StateRow>& mark);
  absl::Status ReadBlobs();
  absl::Status ReadLog();
  absl::Status ReadMissions();
  absl::Status ReadAbandoned();
  absl::Status CheckOrphans();
  void TellClouds();

  void TakeEntry(const LogRow& row, RowDamage damage);
  absl::Status TakeSubmap(const LogRow& row);
  absl::Status TakeClosure(const LogRow& row);
  // Entries that should be there and are not.
  void MissEntries(int64_t first, int64_t last);
  // Named, kept aside with its bytes, and its place taken by `repair`.
  void SetAside(const std::string& what, std::string bytes, Repair repair);
  absl::Status MakeRepairs();

  StoreTables* const tables_;
  StoreIndex* const index_;
  const SubmapStore::Sink* const sink_;
  LossList* const losses_;
  StateRow state_;
  StoreCounters counters_;
  int64_t told_ = 0;
  std::vector<Repair> repairs_;
  std::map<MissionId, std::map<int64_t, std::string>> clouds_;  // by keyframe; empty: gone
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_REPLAY_H_
