// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_DASHBOARD_CLOUD_CACHE_H_
#define OVERTONE_SERVICES_DASHBOARD_CLOUD_CACHE_H_

#include <cstdint>
#include <memory>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "overtone/services/dashboard/map_api.h"
#include "overtone/services/dashboard/map_view.h"

namespace overtone {

// The merged cloud of the newest revision that was asked for, so that many viewers cost the server
// one export. Thread-safe.
class CloudCache {
 public:
  CloudCache(MapApi* api, int64_t max_points) : api_(api), max_points_(max_points) {}

  // A PLY file. Unavailable: another one is being made; ask again. Else what the server says.
  absl::StatusOr<std::shared_ptr<const std::string>> Get(const MapView& view, double voxel_m);

 private:
  struct Key {
    uint64_t epoch = 0;
    uint64_t revision = 0;
    double voxel_m = 0;
  };
  std::shared_ptr<const std::string> Cached(const Key& key);

  MapApi* const api_;
  const int64_t max_points_;
  absl::Mutex export_mutex_;  // held while the server works: one export at a time
  absl::Mutex mutex_;
  Key key_ ABSL_GUARDED_BY(mutex_);
  std::shared_ptr<const std::string> file_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_CLOUD_CACHE_H_
