// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/graph_messages.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {
namespace {

v1::EdgeColumns EncodeEdges(const std::vector<MapEdge>& edges) {
  v1::EdgeColumns columns;
  int previous = 0;
  for (const MapEdge& edge : edges) {
    columns.add_first(edge.first - previous);
    columns.add_span(edge.second - edge.first);
    columns.add_weight(static_cast<float>(edge.weight));
    previous = edge.first;
  }
  return columns;
}

void AddPlainNode(const MapNode& node, v1::MissionNodes& message) {
  v1::Node& out = *message.add_nodes();
  out.set_index(node.index);
  out.set_stamp_ns(node.stamp.ns);
  *out.mutable_map_tform_body() = ToProto(node.map_from_body);
  out.set_submap_start(node.submap_start);
  out.set_degenerate(node.degenerate);
}

absl::StatusOr<MapNode> DecodeNode(const v1::Node& message) {
  MapNode node;
  RETURN_IF_ERROR(ValidateKeyframeIndex(message.index(), "index"));
  node.index = message.index();
  ASSIGN_OR_RETURN(node.stamp, StampFromNanoseconds(message.stamp_ns(), "stamp_ns"));
  ASSIGN_OR_RETURN(node.map_from_body,
                   AtField("map_tform_body", FromProto(message.map_tform_body())));
  node.submap_start = message.submap_start();
  node.degenerate = message.degenerate();
  return node;
}

absl::StatusOr<std::vector<MapNode>> DecodePlain(const v1::MissionNodes& message) {
  std::vector<MapNode> nodes;
  nodes.reserve(message.nodes_size());
  for (int i = 0; i < message.nodes_size(); ++i) {
    ASSIGN_OR_RETURN(MapNode node, AtField("nodes", i, DecodeNode(message.nodes(i))));
    nodes.push_back(std::move(node));
  }
  return nodes;
}

absl::Status ValidateIncreasing(const std::vector<MapNode>& nodes, absl::string_view field) {
  for (size_t i = 1; i < nodes.size(); ++i) {
    if (nodes[i - 1].index < nodes[i].index) continue;
    return InvalidField(field,
                        absl::StrCat("index ", nodes[i].index, " after ", nodes[i - 1].index));
  }
  return absl::OkStatus();
}

// The message's units, or the defaults where PLAIN leaves them out.
absl::StatusOr<ColumnUnits> DecodeUnits(const v1::Graph& message) {
  switch (message.encoding()) {
    case v1::GRAPH_ENCODING_PLAIN:
      return ColumnUnits();
    case v1::GRAPH_ENCODING_COMPACT: {
      const ColumnUnits units = {message.position_resolution_m(), message.rotation_resolution_rad(),
                                 message.stamp_resolution_ns()};
      RETURN_IF_ERROR(units.Validate());
      return units;
    }
    default:
      return InvalidField("encoding", absl::StrCat(message.encoding(), " is not a known one"));
  }
}

absl::StatusOr<std::vector<MapNode>> DecodeNodes(const v1::MissionNodes& message,
                                                 GraphEncoding encoding, const ColumnUnits& units) {
  if (encoding == v1::GRAPH_ENCODING_PLAIN) {
    if (message.has_columns()) return InvalidField("columns", "in a PLAIN graph");
    ASSIGN_OR_RETURN(std::vector<MapNode> nodes, DecodePlain(message));
    RETURN_IF_ERROR(ValidateIncreasing(nodes, "nodes"));
    return nodes;
  }
  if (message.nodes_size() > 0) return InvalidField("nodes", "in a COMPACT graph");
  ASSIGN_OR_RETURN(std::vector<MapNode> nodes,
                   AtField("columns", DecodeColumns(message.columns(), units)));
  RETURN_IF_ERROR(ValidateIncreasing(nodes, "columns.index"));
  return nodes;
}

absl::StatusOr<DecodedMission> DecodeMission(const v1::MissionNodes& message,
                                             GraphEncoding encoding, const ColumnUnits& units) {
  DecodedMission decoded;
  MapMission& mission = decoded.mission;
  ASSIGN_OR_RETURN(mission.id, AtField("id", FromProto(message.id())));
  mission.anchored = message.anchored();
  if (message.component() < 0) return InvalidField("component", "negative");
  mission.component = message.component();
  ASSIGN_OR_RETURN(mission.map_from_mission,
                   AtField("map_tform_mission", FromProto(message.map_tform_mission())));
  ASSIGN_OR_RETURN(mission.nodes, DecodeNodes(message, encoding, units));
  for (int i = 0; i < message.removed_size(); ++i) {
    if (i > 0 && message.removed(i) <= message.removed(i - 1)) {
      return InvalidField(absl::StrCat("removed[", i, "]"), "not increasing");
    }
    decoded.removed.push_back(message.removed(i));
  }
  return decoded;
}

}  // namespace

v1::Graph GraphHeader(const MapGraph& graph, const GraphFormat& format) {
  v1::Graph message;
  message.set_map(format.map);
  message.set_map_epoch(graph.map_epoch);
  message.set_revision(graph.revision);
  message.set_encoding(format.encoding);
  if (format.encoding == v1::GRAPH_ENCODING_COMPACT) {
    message.set_position_resolution_m(format.units.position_m);
    message.set_rotation_resolution_rad(format.units.rotation_rad);
    message.set_stamp_resolution_ns(format.units.stamp_ns);
  }
  if (format.include_edges) *message.mutable_edges() = EncodeEdges(graph.edges);
  message.mutable_edge_rule()->set_radius_m(format.radius_m);
  message.mutable_edge_rule()->set_sigma(format.sigma);
  return message;
}

v1::MissionNodes ToProto(const MapMission& mission, const std::vector<MapNode>& nodes,
                         const GraphFormat& format) {
  v1::MissionNodes message;
  *message.mutable_id() = ToProto(mission.id);
  message.set_anchored(mission.anchored);
  message.set_component(mission.component);
  *message.mutable_map_tform_mission() = ToProto(mission.map_from_mission);
  if (format.encoding == v1::GRAPH_ENCODING_COMPACT) {
    if (!nodes.empty()) *message.mutable_columns() = EncodeColumns(nodes, format.units);
  } else {
    for (const MapNode& node : nodes) AddPlainNode(node, message);
  }
  return message;
}

absl::StatusOr<std::vector<DecodedMission>> DecodeMissions(const v1::Graph& message) {
  ASSIGN_OR_RETURN(const ColumnUnits units, DecodeUnits(message));
  std::vector<DecodedMission> missions;
  missions.reserve(message.missions_size());
  int64_t num_nodes = 0;
  for (int i = 0; i < message.missions_size(); ++i) {
    ASSIGN_OR_RETURN(
        DecodedMission decoded,
        AtField("missions", i, DecodeMission(message.missions(i), message.encoding(), units)));
    if (i > 0 && !(missions.back().mission.id < decoded.mission.id)) {
      return InvalidField(absl::StrCat("missions[", i, "].id"), "not sorted, or twice");
    }
    num_nodes += static_cast<int64_t>(decoded.mission.nodes.size());
    if (num_nodes > limits::kMaxGraphNodes) {
      return InvalidField("missions", "more than 1,000,000 nodes");
    }
    missions.push_back(std::move(decoded));
  }
  return missions;
}

absl::StatusOr<std::vector<MapEdge>> DecodeEdges(const v1::EdgeColumns& columns, int num_nodes) {
  const int count = columns.first_size();
  if (columns.span_size() != count || columns.weight_size() != count) {
    return InvalidField("edges", "columns of different length");
  }
  std::vector<MapEdge> edges;
  edges.reserve(count);
  int64_t first = 0;
  for (int i = 0; i < count; ++i) {
    first += columns.first(i);  // 2^31 numbers below 2^31 cannot overflow an int64
    const int64_t second = first + columns.span(i);
    if (columns.first(i) < 0) {
      return InvalidField(absl::StrCat("edges.first[", i, "]"), "not increasing");
    }
    if (columns.span(i) == 0 || second >= num_nodes) {
      return InvalidField(
          absl::StrCat("edges.span[", i, "]"),
          absl::StrCat("no edge ", first, "-", second, " among ", num_nodes, " nodes"));
    }
    const float weight = columns.weight(i);
    if (!std::isfinite(weight) || weight <= 0) {
      return InvalidField(absl::StrCat("edges.weight[", i, "]"),
                          absl::StrCat(weight, " is not finite and positive"));
    }
    edges.push_back({static_cast<int>(first), static_cast<int>(second), weight});
  }
  return edges;
}

}  // namespace overtone
