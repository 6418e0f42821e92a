// SPDX-License-Identifier: Apache-2.0
// Keeps a copy of a map: asks the server in rounds, and publishes what it learnt.
#ifndef OVERTONE_SERVICES_DASHBOARD_MAP_MIRROR_H_
#define OVERTONE_SERVICES_DASHBOARD_MAP_MIRROR_H_

#include <cstdint>
#include <memory>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/services/dashboard/byte_rates.h"
#include "overtone/services/dashboard/map_api.h"
#include "overtone/services/dashboard/map_view.h"
#include "overtone/services/dashboard/mission_tracker.h"
#include "overtone/services/dashboard/revision_archive.h"

namespace overtone {

struct MirrorOptions {
  // Between two rounds; after one that took longer, twice what it took, so that a large map is not
  // asked for without pause.
  absl::Duration interval = absl::Seconds(1);
  int64_t max_nodes = 200'000;
  size_t max_closures = 20'000;
  size_t max_revisions = 1000;
};

// Thread-safe. One thread of its own asks; nobody else waits for the server.
class MapMirror {
 public:
  // Both must outlive it.
  MapMirror(MapApi* api, RevisionArchive* history, const MirrorOptions& options);
  ~MapMirror();

  std::shared_ptr<const MapView> view() const;
  // The newest view, as soon as it is newer than `version`, or when `timeout` has passed or Stop
  // was called.
  std::shared_ptr<const MapView> WaitForNewer(uint64_t version, absl::Duration timeout) const;
  // The next round begins now.
  void AskNow();
  // Ends the thread; waits for the call it is in.
  void Stop();
  bool stopped() const;

 private:
  void Run();
  absl::Status Round(MapView& view);
  absl::Status LoadRevision(MapView& view);
  void LoadRobots(std::vector<v1::Robot> robots, MapView& view);
  void Publish(MapView view);

  MapApi* const api_;
  RevisionArchive* const history_;
  const MirrorOptions options_;
  // The thread's own.
  MissionTracker tracker_;
  ByteRates rates_;
  uint64_t loaded_epoch_ = 0;
  uint64_t loaded_revision_ = 0;
  int64_t loaded_closures_ = -1;

  mutable absl::Mutex mutex_;
  std::shared_ptr<const MapView> view_ ABSL_GUARDED_BY(mutex_) = std::make_shared<MapView>();
  bool asked_now_ ABSL_GUARDED_BY(mutex_) = false;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;  // last: starts when all else is there
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_MAP_MIRROR_H_
