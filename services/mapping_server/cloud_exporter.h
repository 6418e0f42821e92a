// SPDX-License-Identifier: Apache-2.0
// Merges clouds for ExportMap on a thread of its own, one export after the other.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_CLOUD_EXPORTER_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_CLOUD_EXPORTER_H_

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>

#include "absl/status/statusor.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/services/mapping_server/merged_cloud.h"
#include "overtone/services/mapping_server/worker_pool.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

// Thread-safe.
class CloudExporter {
 public:
  // What follows of a file; empty at its end.
  using NextChunk = std::function<std::string()>;
  using Done = std::function<void(absl::StatusOr<NextChunk>)>;

  // `registry` outlives it. The export in the making and those whose peers take their time have at
  // most `max_points` between them: at the default 1.5 GB of memory.
  explicit CloudExporter(const MapRegistry* registry, int64_t max_points = 2 * kMaxExportPoints)
      : registry_(registry), max_points_(max_points), thread_(1) {}

  // `done` is called once: on its thread, or at once when the request is refused by its fields.
  // The points are in memory until the NextChunk is gone. `wanted`: false ends the work early.
  //
  // Errors as ReadCloudExport's and MergeClouds's. ResourceExhausted: max_points.
  void Start(const v1::ExportMapRequest& request, std::function<bool()> wanted, Done done);

 private:
  absl::StatusOr<NextChunk> Make(const CloudExport& request, const std::function<bool()>& wanted);

  const MapRegistry* const registry_;
  const int64_t max_points_;
  // Of files that are made and not yet sent.
  const std::shared_ptr<std::atomic<int64_t>> in_hand_ = std::make_shared<std::atomic<int64_t>>(0);
  WorkerPool thread_;  // destroyed first
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_CLOUD_EXPORTER_H_
