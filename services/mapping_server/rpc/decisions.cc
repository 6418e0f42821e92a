// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/rpc/decisions.h"

#include <memory>
#include <string>

#include "overtone/proto/conversion/status_conversion.h"
#include "overtone/services/mapping_server/request_id.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

// Vetoing and forcing: the map, the closure, and the same end.
template <typename Request>
grpc::ServerUnaryReactor* Decide(grpc::CallbackServerContext* context, const MapRegistry& registry,
                                 const Request& request, const char* verb,
                                 void (HostedMap::*decide)(const std::string&, HostedMap::Done)) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  const absl::StatusOr<std::shared_ptr<HostedMap>> map = registry.Find(request.map());
  if (!map.ok()) {
    reactor->Finish(ToGrpcStatus(map.status()));
    return reactor;
  }
  ((**map).*decide)(request.id(),
                    [reactor, verb, map = request.map(), id = request.id(),
                     about = AboutCall(*context, request.map())](const absl::Status& status) {
                      const LogScope scope(&about);
                      if (status.ok())
                        spdlog::info("map {}: an operator {} loop closure {}", map, verb, id);
                      reactor->Finish(ToGrpcStatus(status));
                    });
  return reactor;
}

}  // namespace

grpc::ServerUnaryReactor* VetoLoopClosure(grpc::CallbackServerContext* context,
                                          const MapRegistry& registry,
                                          const v1::VetoLoopClosureRequest& request) {
  return Decide(context, registry, request, "vetoed", &HostedMap::Veto);
}

grpc::ServerUnaryReactor* ForceLoopClosure(grpc::CallbackServerContext* context,
                                           const MapRegistry& registry,
                                           const v1::ForceLoopClosureRequest& request) {
  return Decide(context, registry, request, "forced", &HostedMap::Force);
}

grpc::ServerUnaryReactor* RollBack(grpc::CallbackServerContext* context,
                                   const MapRegistry& registry, const v1::RollBackRequest& request,
                                   v1::RollBackResponse* response) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  const absl::StatusOr<std::shared_ptr<HostedMap>> map = registry.Find(request.map());
  if (!map.ok()) {
    reactor->Finish(ToGrpcStatus(map.status()));
    return reactor;
  }
  (*map)->RollBack(request.revision(),
                   [reactor, response, map = request.map(), revision = request.revision(),
                    about = AboutCall(*context, request.map())](
                       const absl::StatusOr<HostedMap::RolledBack>& result) {
                     const LogScope scope(&about);
                     if (result.ok()) {
                       spdlog::info("map {}: rolled back to revision {}, {} loop closures vetoed",
                                    map, revision, result->vetoed);
                       response->set_map_epoch(result->map_epoch);
                       response->set_vetoed(result->vetoed);
                     }
                     reactor->Finish(ToGrpcStatus(result.status()));
                   });
  return reactor;
}

}  // namespace overtone
