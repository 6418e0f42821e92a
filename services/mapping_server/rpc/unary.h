// SPDX-License-Identifier: Apache-2.0
// The unary calls of MappingService, and how every unary call answers.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_UNARY_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_UNARY_H_

#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "grpcpp/grpcpp.h"
#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/services/mapping_server/submap_store.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone {

// Finishes a call whose result is there already.
template <typename Response>
grpc::ServerUnaryReactor* Answer(grpc::CallbackServerContext* context,
                                 absl::StatusOr<Response> result, Response* response) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  if (result.ok()) *response = *std::move(result);
  reactor->Finish(ToGrpcStatus(result.status()));
  return reactor;
}

// Makes the call if it may be made, or finishes with why not.
template <typename Call>
grpc::ServerUnaryReactor* Guarded(grpc::CallbackServerContext* context, const absl::Status& allowed,
                                  Call call) {
  if (allowed.ok()) return call();
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  reactor->Finish(ToGrpcStatus(allowed));
  return reactor;
}

absl::StatusOr<v1::GetServerInfoResponse> ServerInfo(const ServerOptions& options);

absl::StatusOr<v1::GetUploadStateResponse> GetUploadState(const MapRegistry& registry,
                                                          const v1::GetUploadStateRequest& request);

// InvalidArgument naming the field: not 1 to 2000, or one of them breaks a limit in submap.proto.
absl::StatusOr<std::vector<LoopClosureRecord>> CheckClosures(
    const v1::AddLoopClosuresRequest& request);
// Finishes when the store has the closures.
grpc::ServerUnaryReactor* AddLoopClosures(grpc::CallbackServerContext* context,
                                          const MapRegistry& registry,
                                          const v1::AddLoopClosuresRequest& request,
                                          v1::AddLoopClosuresResponse* response);

// Finishes when the map's publisher has built the graph.
grpc::ServerUnaryReactor* GetGraph(grpc::CallbackServerContext* context,
                                   const MapRegistry& registry, int server_max_nodes,
                                   const v1::GetGraphRequest& request,
                                   v1::GetGraphResponse* response);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_UNARY_H_
