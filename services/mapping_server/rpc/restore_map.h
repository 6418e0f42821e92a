// SPDX-License-Identifier: Apache-2.0
// RestoreMap: a backup comes in, is checked as a whole, and takes a map's place.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_RESTORE_MAP_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_RESTORE_MAP_H_

#include <cstdint>
#include <memory>

#include "absl/status/status.h"
#include "grpcpp/grpcpp.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/services/mapping_server/map_maintenance.h"
#include "overtone/services/mapping_server/security/access_control.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

using RestoreReactor = grpc::ServerReadReactor<v1::RestoreMapRequest>;

// Deletes itself when gRPC is done with it. First the one read at a time has it, and a peer that
// goes away ends the reading; then the maintenance's thread.
class RestoreMap : public RestoreReactor {
 public:
  RestoreMap(MapMaintenance* maintenance, const AccessControl* access,
             const grpc::CallbackServerContext* context, v1::RestoreMapResponse* response);

  void OnReadDone(bool ok) override;
  void OnDone() override { delete this; }

 private:
  absl::Status OnMessage();
  absl::Status OnHeader(const v1::RestoreHeader& header);
  absl::Status OnChunk(const std::string& chunk);
  // All is here as it was announced.
  absl::Status CheckWhole();
  absl::Status Restore();
  void End(const absl::Status& status);

  MapMaintenance* const maintenance_;
  const AccessControl* const access_;
  const grpc::CallbackServerContext* const context_;
  v1::RestoreMapResponse* const response_;
  v1::RestoreMapRequest request_;
  v1::RestoreHeader header_;
  std::unique_ptr<MapTransfer> file_;  // null until the header
  int64_t bytes_ = 0;
  Sha256Sum sum_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_RESTORE_MAP_H_
