// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/graph_frames.h"

#include <algorithm>
#include <exception>
#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "grpcpp/impl/codegen/proto_utils.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/proto/conversion/proto_time.h"
#include "overtone/proto/conversion/published_graph.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone {
namespace {

grpc::ByteBuffer Serialise(const v1::WatchGraphResponse& response) {
  grpc::ByteBuffer buffer;
  bool own_buffer = false;
  grpc::SerializationTraits<v1::WatchGraphResponse>::Serialize(response, &buffer, &own_buffer);
  return buffer;
}

absl::Status CheckSize(int64_t size, int64_t limit) {
  if (size <= limit) return absl::OkStatus();
  return absl::ResourceExhaustedError(absl::StrCat("options.max_nodes: the graph takes ", size,
                                                   " bytes, a message at most ", limit,
                                                   "; ask for fewer nodes, COMPACT, or no edges"));
}

// The missions of one robot, closures left out: the graph is built from poses alone.
MapSnapshot OnlyRobot(const MapSnapshot& snapshot, const std::string& robot) {
  MapSnapshot part;
  part.revision = snapshot.revision;
  part.map_epoch = snapshot.map_epoch;
  for (const SnapshotMission& mission : snapshot.missions) {
    if (mission.id.robot == robot) part.missions.push_back(mission);
  }
  return part;
}

}  // namespace

absl::StatusOr<GraphQuery> ReadQuery(const v1::GraphRequestOptions& options, int server_max_nodes) {
  if (options.max_nodes() < 0 || options.max_nodes() > limits::kMaxGraphNodes) {
    return InvalidField("options.max_nodes",
                        absl::StrCat(options.max_nodes(), " is not in [0, 1000000]"));
  }
  if (!options.robot().empty()) RETURN_IF_ERROR(ValidateId(options.robot(), "options.robot"));
  GraphQuery query;
  query.max_nodes =
      options.max_nodes() == 0 ? server_max_nodes : std::min(options.max_nodes(), server_max_nodes);
  query.include_edges = options.include_edges();
  query.robot = options.robot();
  return query;
}

absl::StatusOr<GraphEncoding> ReadEncoding(const v1::GraphRequestOptions& options,
                                           GraphEncoding default_encoding) {
  if (options.encoding() == v1::GRAPH_ENCODING_UNSPECIFIED) return default_encoding;
  if (v1::GraphEncoding_IsValid(options.encoding())) return options.encoding();
  return InvalidField("options.encoding", absl::StrCat(options.encoding(), " is not a known one"));
}

GraphFrames::GraphFrames(std::string map, uint64_t first_epoch, const ServerOptions& options)
    : map_(std::move(map)),
      first_epoch_(first_epoch),
      graph_options_(options.graph),
      options_(options.publisher),
      max_message_bytes_(options.limits.max_message_bytes),
      max_variants_(options.limits.max_watchers_per_map) {}

void GraphFrames::SetSnapshot(std::shared_ptr<const MapSnapshot> snapshot) {
  snapshot_ = std::move(snapshot);
}

GraphPosition GraphFrames::position() const {
  if (snapshot_ == nullptr) return {first_epoch_, 0};
  return {snapshot_->map_epoch, snapshot_->revision};
}

absl::StatusOr<v1::Graph> GraphFrames::Newest(const GraphQuery& query, GraphEncoding encoding) {
  ASSIGN_OR_RETURN(const Variant* variant, Updated(query));
  v1::Graph graph = ToProto(variant->history.back(), Format(query, encoding));
  RETURN_IF_ERROR(CheckSize(static_cast<int64_t>(graph.ByteSizeLong()), max_message_bytes_));
  return graph;
}

absl::StatusOr<grpc::ByteBuffer> GraphFrames::Frame(const GraphQuery& query, GraphEncoding encoding,
                                                    const GraphPosition& reader) {
  ASSIGN_OR_RETURN(Variant * variant, Updated(query));
  const MapGraph& newest = variant->history.back();
  // Never from one epoch to another.
  const auto base =
      std::find_if(variant->history.begin(), variant->history.end(), [&](const MapGraph& graph) {
        return graph.map_epoch == newest.map_epoch && graph.map_epoch == reader.map_epoch &&
               graph.revision == reader.revision;
      });
  const bool delta = base != variant->history.end() && base->revision < newest.revision;
  grpc::ByteBuffer& frame = variant->frames[{encoding, delta ? base->revision : 0}];
  if (!frame.Valid()) {
    v1::WatchGraphResponse response;
    if (delta) {
      *response.mutable_delta() = MakeDelta(*base, newest, Format(query, encoding));
    } else {
      *response.mutable_snapshot() = ToProto(newest, Format(query, encoding));
    }
    frame = Serialise(response);
  }
  RETURN_IF_ERROR(CheckSize(static_cast<int64_t>(frame.Length()), max_message_bytes_));
  return frame;  // shares the bytes
}

grpc::ByteBuffer GraphFrames::Heartbeat() const {
  v1::WatchGraphResponse response;
  v1::Heartbeat& heartbeat = *response.mutable_heartbeat();
  heartbeat.set_map_epoch(position().map_epoch);
  heartbeat.set_revision(position().revision);
  *heartbeat.mutable_server_time() = ToProto(absl::Now());
  return Serialise(response);
}

absl::StatusOr<GraphFrames::Variant*> GraphFrames::Updated(const GraphQuery& query) {
  Variant& variant = variants_[query];
  variant.last_use = ++uses_;
  const bool current = !variant.history.empty() &&
                       variant.history.back().map_epoch == position().map_epoch &&
                       variant.history.back().revision == position().revision;
  if (current) return &variant;

  MakeRoom();
  ASSIGN_OR_RETURN(const MapGraph exact, Build(query));
  const MapGraph& previous = variant.history.empty() ? MapGraph() : variant.history.back();
  variant.history.push_back(PublishedGraph(exact, previous, options_.tolerance, options_.units));
  int64_t more_nodes = variant.history.back().NumNodes();
  if (variant.history.size() > static_cast<size_t>(options_.history)) {
    more_nodes -= variant.history.front().NumNodes();
    variant.history.pop_front();
  }
  variant.nodes += more_nodes;
  nodes_ += more_nodes;
  variant.frames.clear();
  return &variant;
}

absl::StatusOr<MapGraph> GraphFrames::Build(const GraphQuery& query) const {
  MapGraph graph;
  if (snapshot_ != nullptr) {
    GraphMonitorOptions options = graph_options_;
    options.max_nodes = query.max_nodes;
    options.include_edges = query.include_edges;
    try {
      ASSIGN_OR_RETURN(graph, query.robot.empty()
                                  ? BuildMapGraph(*snapshot_, options)
                                  : BuildMapGraph(OnlyRobot(*snapshot_, query.robot), options));
    } catch (const std::exception& error) {
      return absl::InternalError(absl::StrCat("the graph could not be built: ", error.what()));
    }
  }
  graph.map_epoch = position().map_epoch;
  graph.revision = position().revision;
  return graph;
}

void GraphFrames::MakeRoom() {
  while (variants_.size() > 1 && (nodes_ > NodesToKeep() || variants_.size() > max_variants_)) {
    const auto oldest = std::min_element(
        variants_.begin(), variants_.end(),
        [](const auto& a, const auto& b) { return a.second.last_use < b.second.last_use; });
    nodes_ -= oldest->second.nodes;
    variants_.erase(oldest);
  }
}

int64_t GraphFrames::NodesToKeep() const {
  int64_t keyframes = 0;
  if (snapshot_ != nullptr) {
    for (const SnapshotMission& mission : snapshot_->missions) {
      keyframes += static_cast<int64_t>(mission.keyframes.size());
    }
  }
  const int64_t graphs = int64_t{options_.max_variants} * graph_options_.max_nodes;
  // Every robot's own nodes, and as many again.
  return options_.history * std::max(graphs, 2 * keyframes);
}

GraphFormat GraphFrames::Format(const GraphQuery& query, GraphEncoding encoding) const {
  GraphFormat format;
  format.map = map_;
  format.encoding = encoding;
  format.units = options_.units;
  format.include_edges = query.include_edges;
  format.radius_m = graph_options_.radius_graph.radius_m;
  format.sigma = graph_options_.radius_graph.sigma;
  return format;
}

}  // namespace overtone
