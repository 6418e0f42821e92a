// SPDX-License-Identifier: Apache-2.0
// The parts that whole graphs and deltas have in common. Internal to this folder.
#ifndef OVERTONE_PROTO_CONVERSION_GRAPH_MESSAGES_H_
#define OVERTONE_PROTO_CONVERSION_GRAPH_MESSAGES_H_

#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/graph/map_graph.h"
#include "overtone/proto/conversion/graph_conversion.h"
#include "overtone/v1/graph.pb.h"

namespace overtone {

// Everything but missions: header, units, edge rule, and the edges when the format includes them.
v1::Graph GraphHeader(const MapGraph& graph, const GraphFormat& format);
// The mission's header with `nodes` in place of its own.
v1::MissionNodes ToProto(const MapMission& mission, const std::vector<MapNode>& nodes,
                         const GraphFormat& format);

// One mission of a message with its nodes, and (deltas only) the indices it removes.
struct DecodedMission {
  MapMission mission;
  std::vector<int64_t> removed;
};

// Missions sorted by id without twins, indices strictly increasing, at most 1,000,000 nodes.
absl::StatusOr<std::vector<DecodedMission>> DecodeMissions(const v1::Graph& message);
// `num_nodes`: of the graph that the edges belong to.
absl::StatusOr<std::vector<MapEdge>> DecodeEdges(const v1::EdgeColumns& columns, int num_nodes);

}  // namespace overtone

#endif  // OVERTONE_PROTO_CONVERSION_GRAPH_MESSAGES_H_
