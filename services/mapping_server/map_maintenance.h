// SPDX-License-Identifier: Apache-2.0
// An operator's long work on whole maps: backup, restore, verification, deletion. One thread does
// it, one thing after the other, so that it never holds up a robot's calls or a map's thread.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_MAP_MAINTENANCE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_MAP_MAINTENANCE_H_

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/common/ids.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/services/mapping_server/map_transfer.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/services/mapping_server/submap_store.h"
#include "overtone/services/mapping_server/upload_sessions.h"
#include "overtone/services/mapping_server/worker_pool.h"

namespace overtone {

class MapMaintenance {
 public:
  // `registry` and `sessions` outlive it.
  MapMaintenance(const ServerLimits& limits, MapRegistry* registry, UploadSessions* sessions);

  // Runs `work` on its thread, where the calls further down belong.
  void Post(std::function<void()> work) { housekeeper_.Post(std::move(work)); }
  // What waits ends with Unavailable from now on; work under way is finished. Thread-safe.
  void Stop() { stopping_ = true; }

  struct Backup {
    std::unique_ptr<MapTransfer> file;
    int64_t bytes = 0;
    std::string sha256;
  };
  // ResourceExhausted: no room on the disk, or too many transfers.
  absl::StatusOr<Backup> BackUp(const std::string& map);

  // Room for a file that comes in. Before anything is written: InvalidArgument, ResourceExhausted:
  // its size; AlreadyExists: the map, unless it is to be replaced; FailedPrecondition: in memory.
  // Thread-safe and quick.
  absl::StatusOr<std::unique_ptr<MapTransfer>> BeginRestore(const std::string& map, int64_t bytes,
                                                            bool replace);
  struct Restored {
    uint64_t map_epoch = 0;  // 0: no mission in it, no map
    StoreReport report;
  };
  // `file` holds a backup, or DataLoss, FailedPrecondition: nothing is changed. AlreadyExists.
  absl::StatusOr<Restored> Restore(const std::string& map, bool replace, MapTransfer& file);

  absl::StatusOr<StoreReport> Verify(const std::string& map);

  struct Deleted {
    uint64_t map_epoch = 0;  // 0: the map is gone
    int64_t freed_bytes = 0;
  };
  // NotFound: no such map or mission. FailedPrecondition: in memory.
  absl::StatusOr<Deleted> DeleteMission(const std::string& map, const MissionId& mission);
  absl::StatusOr<Deleted> DeleteMap(const std::string& map);

 private:
  absl::StatusOr<std::unique_ptr<MapTransfer>> BeginTransfer(int64_t bytes);
  absl::Status CheckRunning() const;
  absl::StatusOr<Deleted> Delete(const std::string& map,
                                 const std::function<absl::Status(const std::string& path)>& what);
  uint64_t EpochOf(const std::string& map) const;

  const ServerLimits limits_;
  MapRegistry* const registry_;
  UploadSessions* const sessions_;
  std::atomic<bool> stopping_{false};
  const std::shared_ptr<std::atomic<int>> transfers_ = std::make_shared<std::atomic<int>>(0);
  WorkerPool housekeeper_;  // destroyed first
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_MAP_MAINTENANCE_H_
