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

  // `registry` outlives it.
  explicit CloudExporter(const MapRegistry* registry) : registry_(registry), thread_(1) {}

  // `done` is called once: on its thread, or at once when the request is refused. Its memory is
  // taken until the NextChunk is gone. `wanted`: false ends the work early.
  //
  // Errors as ReadCloudExport's and MergeClouds's. ResourceExhausted: the exports under way may
  // take kMaxPointsInHand between them.
  void Start(const v1::ExportMapRequest& request, std::function<bool()> wanted, Done done);

  static constexpr int64_t kMaxPointsInHand = 2 * kMaxExportPoints;  // about 1.5 GB at the worst

 private:
  absl::StatusOr<std::shared_ptr<void>> Reserve(int64_t points);

  const MapRegistry* const registry_;
  const std::shared_ptr<std::atomic<int64_t>> in_hand_ = std::make_shared<std::atomic<int64_t>>(0);
  WorkerPool thread_;  // destroyed first
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_CLOUD_EXPORTER_H_
