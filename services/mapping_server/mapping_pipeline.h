// SPDX-License-Identifier: Apache-2.0
// The single mapping thread of a map. It keeps iterating: take what came, optimise when there is
// something new, publish the frozen result, and again, always with the newest data.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_MAPPING_PIPELINE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_MAPPING_PIPELINE_H_

#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/graph/submap.h"
#include "overtone/core/mapping/map_snapshot.h"
#include "overtone/core/mapping/multi_robot_map.h"
#include "overtone/core/mapping/revision_history.h"

namespace overtone {

// Thread-safe. The destructor waits for the optimisation under way; what waits behind it is
// dropped.
class MappingPipeline {
 public:
  using Publish =
      std::function<void(std::shared_ptr<const MapSnapshot>, const RevisionRecord& what_changed)>;

  // `publish` is called on the mapping thread with every new revision. `options` must be valid.
  MappingPipeline(const MultiRobotMapOptions& options, uint64_t map_epoch, Publish publish);
  ~MappingPipeline();

  // In the order in which they are to be added. Neither blocks on the optimisation.
  void AddSubmap(const MissionId& mission, std::shared_ptr<const Submap> submap);
  void AddLoopClosure(const LoopClosure& closure);
  void AddCandidate(LoopCandidate candidate);
  void AddScoredCandidate(const ScoredCandidate& candidate);
  void AddMotion(const MotionMeasurement& motion);

  // An operator's decision, taken on the mapping thread between two optimisations; `done` is called
  // there with its result. Unavailable: the server is shutting down.
  using Decision = std::function<absl::Status(MultiRobotMap&)>;
  void Decide(Decision decision, std::function<void(const absl::Status&)> done);

  // What waits or is under way: 0 when the last revision holds all that came.
  int64_t backlog() const;

 private:
  struct Work {
    Decision apply;
    std::function<void(const absl::Status&)> done;  // null: a refusal is a defect of ours
  };

  void Enqueue(Decision apply);
  void Run();
  // Waits for work and takes all of it, not more often than every kMinInterval: what comes close
  // together goes into one revision. Empty: the end.
  std::vector<Work> TakeWork();
  void Iterate(const std::vector<Work>& work);

  const Publish publish_;
  MultiRobotMap map_;  // the mapping thread's own
  mutable absl::Mutex mutex_;
  std::vector<Work> work_ ABSL_GUARDED_BY(mutex_);
  int64_t in_hand_ ABSL_GUARDED_BY(mutex_) = 0;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  absl::Time last_work_ ABSL_GUARDED_BY(mutex_) = absl::InfinitePast();
  std::thread thread_;  // last: starts when all else is there
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MAPPING_PIPELINE_H_
