// SPDX-License-Identifier: Apache-2.0
// One map and what keeps it going: its store, its mapping thread and its publisher.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_HOSTED_MAP_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_HOSTED_MAP_H_

#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/core/mapping/map_snapshot.h"
#include "overtone/core/mapping/revision_history.h"
#include "overtone/services/mapping_server/graph_publisher.h"
#include "overtone/services/mapping_server/loop_detector.h"
#include "overtone/services/mapping_server/mapping_pipeline.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/services/mapping_server/submap_store.h"

namespace overtone {

// Thread-safe. Must not be destroyed on one of its own threads.
class HostedMap {
 public:
  HostedMap(std::string id, const ServerOptions& options);

  const std::string& id() const { return id_; }
  // A map that starts empty starts a new epoch, so that readers of an earlier one with the same id
  // notice: the microseconds since 1970. So does a roll-back.
  uint64_t epoch() const { return published().snapshot->map_epoch; }
  SubmapStore& store() { return *store_; }
  const SubmapStore& store() const { return *store_; }
  GraphPublisher& publisher() { return publisher_; }

  struct Published {
    std::shared_ptr<const MapSnapshot> snapshot;  // never null; empty, revision 0, before the first
    absl::Time time = absl::InfinitePast();
  };
  Published published() const;

  struct PublishedRevision {
    RevisionRecord record;
    absl::Time time;
  };
  // Newest first.
  std::vector<PublishedRevision> revisions() const;

  // Operators' decisions; `done` is called when they are taken, on the mapping thread. As
  // MultiRobotMap's.
  using Done = std::function<void(const absl::Status&)>;
  void Veto(const std::string& closure, Done done);
  void Force(const std::string& closure, Done done);
  struct RolledBack {
    uint64_t map_epoch = 0;
    int64_t vetoed = 0;
  };
  void RollBack(uint64_t revision, std::function<void(const absl::StatusOr<RolledBack>&)> done);

  const LoopDetector& detector() const { return detector_; }
  // Clouds, candidates and submaps that the newest revision does not take into account yet. Read it
  // before that revision: then 0 means that the revision holds all.
  int64_t backlog() const { return detector_.backlog() + pipeline_.backlog(); }

 private:
  void OnSnapshot(std::shared_ptr<const MapSnapshot> snapshot, const RevisionRecord& what_changed);

  const std::string id_;
  mutable absl::Mutex mutex_;
  Published published_ ABSL_GUARDED_BY(mutex_);
  std::deque<PublishedRevision> revisions_ ABSL_GUARDED_BY(mutex_);  // newest first
  // Each feeds the one above it, and is destroyed before it.
  GraphPublisher publisher_;
  MappingPipeline pipeline_;
  LoopDetector detector_;
  std::unique_ptr<SubmapStore> store_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_HOSTED_MAP_H_
