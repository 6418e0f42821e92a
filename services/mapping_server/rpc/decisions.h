// SPDX-License-Identifier: Apache-2.0
// The operator's calls that change a map. Each finishes when the mapping thread has taken the
// decision.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_DECISIONS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_DECISIONS_H_

#include "grpcpp/grpcpp.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/v1/map_admin_service.pb.h"

namespace overtone {

grpc::ServerUnaryReactor* VetoLoopClosure(grpc::CallbackServerContext* context,
                                          const MapRegistry& registry,
                                          const v1::VetoLoopClosureRequest& request);

grpc::ServerUnaryReactor* ForceLoopClosure(grpc::CallbackServerContext* context,
                                           const MapRegistry& registry,
                                           const v1::ForceLoopClosureRequest& request);

grpc::ServerUnaryReactor* RollBack(grpc::CallbackServerContext* context,
                                   const MapRegistry& registry, const v1::RollBackRequest& request,
                                   v1::RollBackResponse* response);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_DECISIONS_H_
