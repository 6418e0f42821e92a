// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/graph_conversion.h"

#include <utility>

#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/graph_messages.h"

namespace overtone {

v1::Graph ToProto(const MapGraph& graph, const GraphFormat& format) {
  v1::Graph message = GraphHeader(graph, format);
  for (const MapMission& mission : graph.missions) {
    *message.add_missions() = ToProto(mission, mission.nodes, format);
  }
  return message;
}

absl::StatusOr<MapGraph> FromProto(const v1::Graph& message) {
  MapGraph graph;
  graph.revision = message.revision();
  graph.map_epoch = message.map_epoch();
  ASSIGN_OR_RETURN(std::vector<DecodedMission> missions, DecodeMissions(message));
  for (size_t i = 0; i < missions.size(); ++i) {
    if (!missions[i].removed.empty()) {
      return AtField("missions", static_cast<int>(i), InvalidField("removed", "in a whole graph"));
    }
    graph.missions.push_back(std::move(missions[i].mission));
  }
  ASSIGN_OR_RETURN(graph.edges, DecodeEdges(message.edges(), graph.NumNodes()));
  return graph;
}

}  // namespace overtone
