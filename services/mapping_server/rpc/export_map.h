// SPDX-License-Identifier: Apache-2.0
// ExportMap: the newest revision as a file, in chunks of at most 256 KiB.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_EXPORT_MAP_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_EXPORT_MAP_H_

#include <cstddef>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "grpcpp/support/server_callback.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

using ExportReactor = grpc::ServerWriteReactor<v1::ExportMapResponse>;

// Deletes itself when gRPC is done with it.
class ExportMap : public ExportReactor {
 public:
  // `file`: the whole text, or why there is none.
  explicit ExportMap(absl::StatusOr<std::string> file);

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  void WriteNext() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void FinishWith(const absl::Status& status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  absl::Mutex mutex_;
  std::string file_ ABSL_GUARDED_BY(mutex_);
  size_t next_ ABSL_GUARDED_BY(mutex_) = 0;  // byte
  v1::ExportMapResponse response_ ABSL_GUARDED_BY(mutex_);
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_EXPORT_MAP_H_
