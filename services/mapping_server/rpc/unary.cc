// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/rpc/unary.h"

#include <memory>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/proto/conversion/proto_time.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/services/mapping_server/submap_digest.h"

namespace overtone {

absl::StatusOr<std::vector<LoopClosureRecord>> CheckClosures(
    const v1::AddLoopClosuresRequest& request) {
  const int count = request.loop_closures_size();
  if (count < 1 || count > limits::kMaxLoopClosuresPerRequest) {
    return InvalidField("loop_closures", absl::StrCat(count, " of them, not 1 to 2000"));
  }
  std::vector<LoopClosureRecord> records;
  records.reserve(count);
  for (int i = 0; i < count; ++i) {
    const v1::LoopClosure& message = request.loop_closures(i);
    ASSIGN_OR_RETURN(LoopClosure closure, AtField("loop_closures", i, FromProto(message)));
    std::string bytes = DeterministicBytes(message);
    std::string digest = Sha256(bytes);
    records.push_back({std::move(closure), std::move(bytes), std::move(digest)});
  }
  return records;
}

absl::StatusOr<v1::GetServerInfoResponse> ServerInfo(const ServerOptions& options) {
  v1::GetServerInfoResponse response;
  response.set_version(OVERTONE_VERSION);
  response.set_protocol("overtone.v1");
  v1::ServerLimits& message = *response.mutable_limits();
  message.set_max_message_bytes(options.limits.max_message_bytes);
  message.set_max_keyframes_per_submap(limits::kMaxKeyframesPerSubmap);
  message.set_max_loop_closures_per_submap(limits::kMaxLoopClosuresPerSubmap);
  message.set_max_nodes(options.graph.max_nodes);
  message.set_upload_window_bytes(options.limits.upload_window_bytes);
  message.set_max_missions_per_map(options.limits.max_missions_per_map);
  message.set_max_keyframes_per_mission(options.limits.max_keyframes_per_mission);
  message.set_max_blob_bytes(options.limits.max_blob_bytes);
  for (const char* feature : {"compact", "delta", "kron_reduction", "clouds", "landmarks"}) {
    response.add_features(feature);
  }
  *response.mutable_server_time() = ToProto(absl::Now());
  return response;
}

absl::StatusOr<v1::GetUploadStateResponse> GetUploadState(
    const MapRegistry& registry, const v1::GetUploadStateRequest& request) {
  RETURN_IF_ERROR(ValidateId(request.map(), "map"));
  ASSIGN_OR_RETURN(const MissionId mission, AtField("mission", FromProto(request.mission())));
  const absl::StatusOr<std::shared_ptr<HostedMap>> map = registry.Find(request.map());
  if (!map.ok() && !absl::IsNotFound(map.status())) return map.status();
  const UploadState state = map.ok() ? (*map)->store().State(mission) : UploadState();
  v1::GetUploadStateResponse response;
  response.set_next_sequence(state.next_sequence);
  response.set_next_index(state.next_index);
  response.set_missing_blobs(state.missing_blobs);
  return response;
}

grpc::ServerUnaryReactor* AddLoopClosures(grpc::CallbackServerContext* context,
                                          const MapRegistry& registry,
                                          const v1::AddLoopClosuresRequest& request,
                                          v1::AddLoopClosuresResponse* response) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  const absl::StatusOr<std::shared_ptr<HostedMap>> map = registry.Find(request.map());
  absl::StatusOr<std::vector<LoopClosureRecord>> records = CheckClosures(request);
  if (!map.ok() || !records.ok()) {
    reactor->Finish(ToGrpcStatus(!map.ok() ? map.status() : records.status()));
    return reactor;
  }
  (*map)->store().AppendLoopClosures(*std::move(records),
                                     [reactor, response](const absl::StatusOr<int>& added) {
                                       if (added.ok()) response->set_added(*added);
                                       reactor->Finish(ToGrpcStatus(added.status()));
                                     });
  return reactor;
}

grpc::ServerUnaryReactor* GetGraph(grpc::CallbackServerContext* context,
                                   const MapRegistry& registry, int server_max_nodes,
                                   const v1::GetGraphRequest& request,
                                   v1::GetGraphResponse* response) {
  grpc::ServerUnaryReactor* reactor = context->DefaultReactor();
  const absl::StatusOr<std::shared_ptr<HostedMap>> map = registry.Find(request.map());
  const absl::StatusOr<GraphQuery> query = ReadQuery(request.options(), server_max_nodes);
  const absl::StatusOr<GraphEncoding> encoding =
      ReadEncoding(request.options(), v1::GRAPH_ENCODING_PLAIN);
  for (const absl::Status& status : {map.status(), query.status(), encoding.status()}) {
    if (status.ok()) continue;
    reactor->Finish(ToGrpcStatus(status));
    return reactor;
  }
  (*map)->publisher().GetNewest(*query, *encoding,
                                [reactor, response](absl::StatusOr<v1::Graph> graph) {
                                  if (graph.ok()) *response->mutable_graph() = *std::move(graph);
                                  reactor->Finish(ToGrpcStatus(graph.status()));
                                });
  return reactor;
}

}  // namespace overtone
