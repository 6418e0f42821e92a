// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/mapping_service.h"

#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/rpc/unary.h"
#include "overtone/services/mapping_server/rpc/upload_submaps.h"
#include "overtone/services/mapping_server/rpc/watch_graph.h"

namespace overtone {

MappingService::MappingService(const ServerOptions& options, AccessControl* access,
                               MapRegistry* registry, UploadSessions* sessions)
    : options_(options), access_(access), registry_(registry), sessions_(sessions) {}

grpc::ServerUnaryReactor* MappingService::GetServerInfo(grpc::CallbackServerContext* context,
                                                        const v1::GetServerInfoRequest*,
                                                        v1::GetServerInfoResponse* response) {
  return Answer(context, ServerInfo(options_), response);
}

grpc::ServerBidiReactor<v1::UploadSubmapsRequest, v1::UploadSubmapsResponse>*
MappingService::UploadSubmaps(grpc::CallbackServerContext* context) {
  return overtone::UploadSubmaps::Start(StreamAccess(access_, *context), registry_, sessions_,
                                        options_.limits);
}

grpc::ServerUnaryReactor* MappingService::GetUploadState(grpc::CallbackServerContext* context,
                                                         const v1::GetUploadStateRequest* request,
                                                         v1::GetUploadStateResponse* response) {
  const absl::Status may =
      access_->MayWrite(*context, request->map(), request->mission().robot(), "");
  return Guarded(context, may, [&] {
    return Answer(context, overtone::GetUploadState(*registry_, *request), response);
  });
}

grpc::ServerUnaryReactor* MappingService::AddLoopClosures(grpc::CallbackServerContext* context,
                                                          const v1::AddLoopClosuresRequest* request,
                                                          v1::AddLoopClosuresResponse* response) {
  return Guarded(context, access_->MayAddClosures(*context, *request), [&] {
    return overtone::AddLoopClosures(context, *registry_, *request, response);
  });
}

grpc::ServerWriteReactor<grpc::ByteBuffer>* MappingService::WatchGraph(
    grpc::CallbackServerContext* context, const grpc::ByteBuffer* request) {
  return overtone::WatchGraph::Start(StreamAccess(access_, *context), registry_,
                                     options_.graph.max_nodes, *request);
}

grpc::ServerUnaryReactor* MappingService::GetGraph(grpc::CallbackServerContext* context,
                                                   const v1::GetGraphRequest* request,
                                                   v1::GetGraphResponse* response) {
  return Guarded(context, access_->MayRead(*context, request->map()), [&] {
    return overtone::GetGraph(context, *registry_, options_.graph.max_nodes, *request, response);
  });
}

}  // namespace overtone
