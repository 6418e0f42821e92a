// SPDX-License-Identifier: Apache-2.0
// BackupMap: a copy of a map's store, made and measured first, then sent in chunks.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_BACKUP_MAP_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_BACKUP_MAP_H_

#include <memory>
#include <string>

#include "absl/status/status.h"
#include "grpcpp/grpcpp.h"
#include "overtone/services/mapping_server/map_maintenance.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

using BackupReactor = grpc::ServerWriteReactor<v1::BackupMapResponse>;

// Deletes itself when gRPC is done with it. First the maintenance's thread has it, then the one
// write at a time (nobody, when the caller may not): a peer that goes away shows in the write that
// fails.
class BackupMap : public BackupReactor {
 public:
  BackupMap(MapMaintenance* maintenance, const grpc::CallbackServerContext* context,
            const std::string& map, const absl::Status& may);

  void OnWriteDone(bool ok) override;
  void OnDone() override { delete this; }

 private:
  absl::Status Begin(MapMaintenance& maintenance, const grpc::CallbackServerContext& context,
                     const std::string& map);
  absl::Status WriteNext();
  void End(const absl::Status& status);

  std::unique_ptr<MapTransfer> file_;
  v1::BackupMapResponse response_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_BACKUP_MAP_H_
