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
#include "overtone/core/common/ids.h"
#include "overtone/core/graph/submap.h"
#include "overtone/core/mapping/map_snapshot.h"
#include "overtone/core/mapping/multi_robot_map.h"

namespace overtone {

// Thread-safe. The destructor waits for the optimisation under way; what waits behind it is
// dropped.
class MappingPipeline {
 public:
  using Publish = std::function<void(std::shared_ptr<const MapSnapshot>)>;

  // `publish` is called on the mapping thread with every new revision. `options` must be valid.
  MappingPipeline(const MultiRobotMapOptions& options, uint64_t map_epoch, Publish publish);
  ~MappingPipeline();

  // In the order in which they are to be added. Neither blocks on the optimisation.
  void AddSubmap(const MissionId& mission, std::shared_ptr<const Submap> submap);
  void AddLoopClosure(const LoopClosure& closure);
  // The encoded cloud of a keyframe whose submap was added before. The map makes no use of clouds
  // yet.
  void AddCloud(const NodeId& /*keyframe*/, std::shared_ptr<const std::string> /*blob*/) {}

 private:
  using Work = std::function<absl::Status(MultiRobotMap&)>;

  void Enqueue(Work work);
  void Run();
  // Waits for work and takes all of it; empty: the end.
  std::vector<Work> TakeWork();
  void Iterate(const std::vector<Work>& work);

  const Publish publish_;
  MultiRobotMap map_;  // the mapping thread's own
  absl::Mutex mutex_;
  std::vector<Work> work_ ABSL_GUARDED_BY(mutex_);
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;  // last: starts when all else is there
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MAPPING_PIPELINE_H_
