// SPDX-License-Identifier: Apache-2.0
// One map and what keeps it going: its store, its mapping thread and its publisher.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_HOSTED_MAP_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_HOSTED_MAP_H_

#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "absl/types/optional.h"
#include "overtone/core/mapping/map_snapshot.h"
#include "overtone/core/mapping/revision_history.h"
#include "overtone/services/mapping_server/graph_publisher.h"
#include "overtone/services/mapping_server/loop_detector.h"
#include "overtone/services/mapping_server/map_log.h"
#include "overtone/services/mapping_server/mapping_pipeline.h"
#include "overtone/services/mapping_server/metrics/map_instruments.h"
#include "overtone/services/mapping_server/robot_traffic.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/services/mapping_server/status_reports.h"
#include "overtone/services/mapping_server/submap_store.h"

namespace overtone {

// Thread-safe. Must not be destroyed on one of its own threads.
class HostedMap {
 public:
  // kNew: what readers hold of the map is not to be built upon, as after a mission was deleted.
  enum class Epoch { kKeep, kNew };

  // With all that its store holds: what was last published is there again when this returns.
  // `path`: of the store's file, or ":memory:".
  static absl::StatusOr<std::unique_ptr<HostedMap>> Open(std::string id, std::string path,
                                                         const ServerOptions& options, Epoch epoch);
  ~HostedMap();

  const std::string& id() const { return id_; }
  // A map that starts empty starts a new epoch, so that readers of an earlier one with the same id
  // notice: the microseconds since 1970. So does a roll-back. A restart does not.
  uint64_t epoch() const { return published().snapshot->map_epoch; }
  SubmapStore& store() { return *store_; }
  const SubmapStore& store() const { return *store_; }
  GraphPublisher& publisher() { return *publisher_; }
  // Both begin anew when the map is opened.
  StatusReports& reports() { return reports_; }
  RobotTraffic& traffic() { return traffic_; }

  const MapInstruments& instruments() const { return instruments_; }

  struct Published {
    std::shared_ptr<const MapSnapshot> snapshot;  // never null; empty, revision 0, before the first
    absl::Time time = absl::InfinitePast();
  };
  Published published() const;

  struct KeptRevision {
    RevisionRecord record;
    absl::optional<CycleTimes> times;  // of this process' own revisions
  };
  // Newest first.
  std::vector<KeptRevision> revisions() const;

  // Operators' decisions; `done` is called when they are taken and durable, on any thread. As
  // MultiRobotMap's. ResourceExhausted: taken, but lost with the next restart.
  using Done = std::function<void(const absl::Status&)>;
  void Veto(const std::string& closure, Done done);
  void Force(const std::string& closure, Done done);
  struct RolledBack {
    uint64_t map_epoch = 0;
    int64_t vetoed = 0;
  };
  void RollBack(uint64_t revision, std::function<void(const absl::StatusOr<RolledBack>&)> done);

  const LoopDetector& detector() const { return *detector_; }
  // What was stored or found, and the newest revision does not take into account yet. Read it
  // before that revision: then 0 means that the revision holds all.
  int64_t backlog() const {
    // In the order in which things move on: what leaves one is with the next by then.
    const int64_t to_store = store_->Backlog();
    const int64_t to_find = detector_->backlog();
    const int64_t found = store_->Backlog();
    return to_store + to_find + found + pipeline_->backlog();
  }
  // Its parts: what waits for the disk, for the search for closures, for the optimiser.
  struct QueueDepths {
    int64_t store = 0;
    int64_t detector = 0;
    int64_t pipeline = 0;
  };
  QueueDepths queue_depths() const {
    return {store_->Backlog(), detector_->backlog(), pipeline_->backlog()};
  }

 private:
  HostedMap(std::string id, std::string path, const ServerOptions& options)
      : id_(std::move(id)),
        path_(std::move(path)),
        options_(options),
        // As many as robots can have missions here.
        traffic_(static_cast<size_t>(options.limits.max_missions_per_map)) {}

  absl::Status Start(Epoch epoch);
  absl::Status Replay(Epoch epoch);
  SubmapStore::Sink StoreSink();
  LoopDetector::Sink DetectorSink();
  void OnFinding(const std::string& bytes);
  void NoteForDetector(const Finding& finding);
  void StoreFinding(const Finding& finding);
  void OnSnapshot(std::shared_ptr<const MapSnapshot> snapshot, const RevisionHistory& history);
  void OnTimed(uint64_t revision, const CycleTimes& times);
  // Takes the decision, and makes what then stands durable.
  void Decide(MappingPipeline::Decision decision, Done done);

  const std::string id_;
  const std::string path_;
  const ServerOptions options_;
  StatusReports reports_;
  RobotTraffic traffic_;
  MapInstruments instruments_;
  mutable absl::Mutex mutex_;
  Published published_ ABSL_GUARDED_BY(mutex_);
  std::deque<KeptRevision> revisions_ ABSL_GUARDED_BY(mutex_);  // newest first
  bool replaying_ = false;                                      // in Start only
  MapDecisions replayed_;                                       // likewise
  // From what comes to what goes out:
  //   robots -> store -> detector -> store -> pipeline -> publisher
  // The log is written first: what is in the map is on disk. The store is closed after the pipeline
  // has put its last checkpoint there, and no one answers its calls before all is gone.
  std::unique_ptr<SubmapStore> store_;
  std::unique_ptr<GraphPublisher> publisher_;
  std::unique_ptr<MappingPipeline> pipeline_;
  std::unique_ptr<LoopDetector> detector_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_HOSTED_MAP_H_
