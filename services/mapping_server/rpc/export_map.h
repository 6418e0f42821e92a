// SPDX-License-Identifier: Apache-2.0
// ExportMap: the newest revision as a file, in chunks of at most 256 KiB.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_EXPORT_MAP_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_EXPORT_MAP_H_

#include <atomic>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "grpcpp/support/server_callback.h"
#include "overtone/services/mapping_server/cloud_exporter.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

using ExportReactor = grpc::ServerWriteReactor<v1::ExportMapResponse>;

// Deletes itself when gRPC is done with it, which is not before a file that is being made is made.
class ExportMap : public ExportReactor {
 public:
  // `may`: not ok ends the call with it. Text is made at once, clouds are the exporter's work.
  ExportMap(const absl::Status& may, const MapRegistry& registry, CloudExporter* exporter,
            const v1::ExportMapRequest& request);

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  using NextChunk = CloudExporter::NextChunk;

  void Begin(absl::StatusOr<NextChunk> file);
  void WriteNext() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void FinishWith(const absl::Status& status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  std::atomic<bool> cancelled_{false};
  absl::Mutex mutex_;
  bool making_ ABSL_GUARDED_BY(mutex_) = true;  // Begin will come
  NextChunk next_chunk_ ABSL_GUARDED_BY(mutex_);
  v1::ExportMapResponse response_ ABSL_GUARDED_BY(mutex_);
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_EXPORT_MAP_H_
