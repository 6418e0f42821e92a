// SPDX-License-Identifier: Apache-2.0
// The one thread that writes a store: takes what waits, makes it durable with one fsync, tells the
// sink, answers.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_WRITER_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_WRITER_H_

#include <cstdint>
#include <memory>
#include <string>
#include <thread>

#include "absl/status/status.h"
#include "overtone/services/mapping_server/metrics/map_instruments.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/services/mapping_server/submap_store.h"
#include "overtone/services/mapping_server/submap_store/loss_list.h"
#include "overtone/services/mapping_server/submap_store/operation_queue.h"
#include "overtone/services/mapping_server/submap_store/store_file.h"
#include "overtone/services/mapping_server/submap_store/store_index.h"
#include "overtone/services/mapping_server/submap_store/store_replay.h"

namespace overtone {

struct StoreOptions {
  // A registered SQLite VFS; empty: the system's.
  std::string vfs;
  // Of one transaction: how long a neighbour may have to wait, against how many share an fsync.
  OperationQueue::BatchLimits batch;
  // Pages of 4 KiB in the write-ahead log before they are moved into the database: when there is
  // nothing else to do, and in any case.
  int checkpoint_pages_when_idle = 1000;
  int checkpoint_pages = 4000;
  // Told of every commit; null: nobody.
  StoreInstruments* instruments = nullptr;
  // Whose store it is, for the log.
  std::string map;
};

// Push, Drain and Backlog are thread-safe. All else by one thread.
class StoreWriter {
 public:
  StoreWriter(StoreFile* file, StoreIndex* index, LossList* losses, const ServerLimits& limits,
              SubmapStore::Sink sink, const StoreOptions& options);
  // Finishes what waits. Operations that never had a writer end with Unavailable.
  ~StoreWriter();

  // Reads what is stored into the index and tells the sink, once, before Start.
  absl::Status Replay();
  // From now on operations are carried out; what was pushed before waits until here.
  void Start();
  bool started() const { return thread_.joinable(); }

  void Push(std::unique_ptr<StoreOperation> operation);
  // Waits until all that was pushed is finished. Only after Start.
  void Drain() const { queue_.AwaitFinished(); }
  int64_t Backlog() const { return queue_.unfinished(); }

 private:
  void Run();
  // One batch from the queue, which is not empty; the number of its operations.
  size_t Process();
  // Writes and commits, again after a salvage when the file turns out to be damaged. Not ok:
  // nothing is stored.
  absl::Status Store(OperationBatch& batch);
  absl::Status TryToStore(OperationBatch& batch, StoreTables& tables);
  // The index as the file is after a salvage; the sink is not told.
  absl::Status Reload();
  void CheckpointIfDue();
  void Count(const absl::Status& status, size_t operations, double seconds);

  StoreFile* const file_;
  StoreIndex* const index_;
  LossList* const losses_;
  const ServerLimits limits_;
  const SubmapStore::Sink sink_;
  const StoreOptions options_;
  OperationQueue queue_;
  // The thread's own.
  StateRow state_;
  StoreCounters counters_;
  bool disk_fails_ = false;  // said so already
  std::thread thread_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_STORE_WRITER_H_
