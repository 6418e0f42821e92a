// SPDX-License-Identifier: Apache-2.0
// VerifyMap, DeleteMission, DeleteMap: each finishes when the maintenance's thread has done it.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_HOUSEKEEPING_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_HOUSEKEEPING_H_

#include "grpcpp/grpcpp.h"
#include "overtone/services/mapping_server/map_maintenance.h"
#include "overtone/services/mapping_server/submap_store.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

v1::StoreReport ToProto(const StoreReport& report);

// `request` and `response` are there until the call is finished, as gRPC has them.
grpc::ServerUnaryReactor* VerifyMap(grpc::CallbackServerContext* context,
                                    MapMaintenance* maintenance,
                                    const v1::VerifyMapRequest* request,
                                    v1::VerifyMapResponse* response);

grpc::ServerUnaryReactor* DeleteMission(grpc::CallbackServerContext* context,
                                        MapMaintenance* maintenance,
                                        const v1::DeleteMissionRequest* request,
                                        v1::DeleteMissionResponse* response);

grpc::ServerUnaryReactor* DeleteMap(grpc::CallbackServerContext* context,
                                    MapMaintenance* maintenance,
                                    const v1::DeleteMapRequest* request,
                                    v1::DeleteMapResponse* response);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_HOUSEKEEPING_H_
