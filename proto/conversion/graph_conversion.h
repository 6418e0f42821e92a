// SPDX-License-Identifier: Apache-2.0
// The graph a robot receives, whole and as the difference between two revisions.
#ifndef OVERTONE_PROTO_CONVERSION_GRAPH_CONVERSION_H_
#define OVERTONE_PROTO_CONVERSION_GRAPH_CONVERSION_H_

#include <string>

#include "absl/status/statusor.h"
#include "overtone/core/graph/map_graph.h"
#include "overtone/proto/conversion/graph_columns.h"
#include "overtone/v1/graph.pb.h"

namespace overtone {

using GraphEncoding = v1::GraphEncoding;

// How a graph is written.
struct GraphFormat {
  std::string map;
  GraphEncoding encoding = v1::GRAPH_ENCODING_COMPACT;
  ColumnUnits units;  // of COMPACT
  bool include_edges = false;
  // The rule by which the receiver rebuilds edges: metres, unitless.
  double radius_m = 7.0;
  double sigma = 1.0;
};

// PLAIN keeps every bit; COMPACT keeps every bit of a graph that PublishedGraph() made, and rounds
// others.
v1::Graph ToProto(const MapGraph& graph, const GraphFormat& format);

// InvalidArgument naming the field when a rule in graph.proto is broken: safe against any input.
// The result holds edges only when the message carries them.
absl::StatusOr<MapGraph> FromProto(const v1::Graph& message);

// ApplyDelta(base, MakeDelta(base, target, format)) == target, bit by bit for graphs made by
// PublishedGraph() (edges only when the format includes them). Both graphs are of one epoch.
v1::GraphDelta MakeDelta(const MapGraph& base, const MapGraph& target, const GraphFormat& format);

// FailedPrecondition: the delta applies to another revision or epoch: ask for a snapshot.
// InvalidArgument naming the field: it contradicts its base (removes what is not there) or breaks a
// rule in graph.proto.
absl::StatusOr<MapGraph> ApplyDelta(const MapGraph& base, const v1::GraphDelta& delta);

}  // namespace overtone

#endif  // OVERTONE_PROTO_CONVERSION_GRAPH_CONVERSION_H_
