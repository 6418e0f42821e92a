// SPDX-License-Identifier: Apache-2.0
// The single mapping thread of a map. It keeps iterating: take what came, optimise when there is
// something new, publish the frozen result, and again, always with the newest data.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_MAPPING_PIPELINE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_MAPPING_PIPELINE_H_

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "absl/types/optional.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/graph/submap.h"
#include "overtone/core/mapping/map_snapshot.h"
#include "overtone/core/mapping/multi_robot_map.h"
#include "overtone/core/mapping/revision_history.h"
#include "overtone/services/mapping_server/checkpoint_codec.h"
#include "overtone/services/mapping_server/map_log.h"
#include "overtone/services/mapping_server/metrics/map_instruments.h"

namespace overtone {

// Thread-safe. The destructor gives up the optimisation under way, within an iteration of its
// solver, and what waits behind it: all that is in the log. Where nothing was under way it stores a
// last checkpoint.
class MappingPipeline {
 public:
  struct Sink {
    // Every new revision, on the mapping thread; from Start on the caller's, when the map comes
    // back.
    std::function<void(std::shared_ptr<const MapSnapshot>, const RevisionHistory&)> publish;
    // Keeps a checkpoint; `done` says whether it is durable.
    std::function<void(std::string bytes, std::function<void(absl::Status)> done)> store;
    // After publish, where the time of the cycle went; may be null.
    std::function<void(uint64_t revision, const CycleTimes&)> timed;
    // Of the log's lines.
    std::string map;
  };

  // `options` must be valid. Nothing moves before Start. The map's epoch comes with the first
  // MapDecisions.
  MappingPipeline(const MultiRobotMapOptions& options, Sink sink);
  ~MappingPipeline();

  // What was added up to now is the stored log, `checkpoint` what is kept beside it: the map is
  // published again as it was, and then goes on. One that does not fit is passed over.
  void Start(const absl::optional<StoredCheckpoint>& checkpoint);

  // The entries of the map's log, in its order. None blocks on the optimisation.
  void AddSubmap(const MissionId& mission, std::shared_ptr<const Submap> submap);
  void AddLoopClosure(const LoopClosure& closure);
  // Decisions are in effect already, but for those of the stored log.
  void AddFinding(Finding finding);

  // An operator's decision, taken on the mapping thread between two optimisations; `done` is called
  // there with its result. Unavailable: the server is shutting down.
  using Decision = std::function<absl::Status(MultiRobotMap&)>;
  void Decide(Decision decision, std::function<void(const absl::Status&)> done);

  // What waits or is under way: 0 when the last revision holds all that came.
  int64_t backlog() const;

 private:
  struct Work {
    Decision apply;
    std::function<void(const absl::Status&)> done;  // null: an entry of the log
  };

  void Enqueue(Decision apply);
  void Run();
  // Waits for work and takes all of it, not more often than every kMinInterval: what comes close
  // together goes into one revision. Empty: nothing came before a checkpoint was due, or the end.
  std::vector<Work> TakeWork();
  bool Stopping() const;
  void Apply(const Work& work);
  void Iterate(const std::vector<Work>& work);
  bool Restore(StoredCheckpoint checkpoint);
  // Revisions up to `reserved_through` are given away with it.
  void StoreCheckpoint(uint64_t reserved_through);
  void StoreCheckpointAndWait(uint64_t reserved_through);
  bool IsStored(uint64_t reserved_through) const;
  void StoreCheckpointWhenDue();

  const Sink sink_;
  // The mapping thread's own, and before it starts the caller's of Start.
  MultiRobotMap map_;
  int64_t entries_ = 0;           // of the log, that the map has
  uint64_t stored_revision_ = 0;  // of the last checkpoint that was given to the store
  int64_t stored_entries_ = 0;    // likewise
  absl::Time checkpoint_due_ = absl::InfinitePast();
  std::atomic<bool> give_up_{false};  // the optimisation under way

  mutable absl::Mutex mutex_;
  std::vector<Work> work_ ABSL_GUARDED_BY(mutex_);
  int64_t in_hand_ ABSL_GUARDED_BY(mutex_) = 0;
  bool started_ ABSL_GUARDED_BY(mutex_) = false;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  absl::Time last_work_ ABSL_GUARDED_BY(mutex_) = absl::InfinitePast();
  int checkpoints_under_way_ ABSL_GUARDED_BY(mutex_) = 0;
  uint64_t reserved_through_ ABSL_GUARDED_BY(mutex_) = 0;  // durably
  std::thread thread_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MAPPING_PIPELINE_H_
