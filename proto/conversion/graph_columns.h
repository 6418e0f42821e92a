// SPDX-License-Identifier: Apache-2.0
// The COMPACT encoding: nodes as delta-coded columns of integers. Protobuf writes them as varints,
// so a node of a smooth trajectory takes about 17 bytes instead of 72 and more.
#ifndef OVERTONE_PROTO_CONVERSION_GRAPH_COLUMNS_H_
#define OVERTONE_PROTO_CONVERSION_GRAPH_COLUMNS_H_

#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/graph/map_graph.h"
#include "overtone/v1/graph.pb.h"

namespace overtone {

// The units of the columns. Defaults: well below the noise of any odometry or closure (centimetres,
// milliradians). Largest error, half a unit on each axis: 0.43 mm, 0.09 mrad (0.17 mrad within 0.1
// mrad of a half turn), 0.5 us.
struct ColumnUnits {
  double position_m = 5e-4;
  double rotation_rad = 1e-4;
  int64_t stamp_ns = 1000;

  absl::Status Validate() const;  // names the fields of v1::Graph
};

v1::NodeColumns EncodeColumns(const std::vector<MapNode>& nodes, const ColumnUnits& units);

// InvalidArgument naming the column: lengths that differ, sums that overflow, values out of the
// schema's range. `units` are valid. Indices need not increase; the caller checks that for both
// encodings.
absl::StatusOr<std::vector<MapNode>> DecodeColumns(const v1::NodeColumns& columns,
                                                   const ColumnUnits& units);

// The value that a node has after a trip through the columns. Quantised(Quantised(x)) ==
// Quantised(x), bit by bit.
MapNode Quantised(const MapNode& node, const ColumnUnits& units);

}  // namespace overtone

#endif  // OVERTONE_PROTO_CONVERSION_GRAPH_COLUMNS_H_
