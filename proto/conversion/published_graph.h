// SPDX-License-Identifier: Apache-2.0
// From the exact graph of a new revision to the one that is published. Optimising moves every pose
// a little every time; a pose that moved less than the tolerance stays as it was published before,
// and its bytes need not be sent.
#ifndef OVERTONE_PROTO_CONVERSION_PUBLISHED_GRAPH_H_
#define OVERTONE_PROTO_CONVERSION_PUBLISHED_GRAPH_H_

#include "absl/status/status.h"
#include "overtone/core/graph/map_graph.h"
#include "overtone/proto/conversion/graph_columns.h"

namespace overtone {

// The largest error of a published pose; no drift, since the exact pose is what is compared.
// Defaults: a tenth of the noise of a good closure (3 cm, 0.5 deg).
struct PublicationTolerance {
  double position_m = 2e-3;
  double rotation_rad = 5e-4;

  // InvalidArgument when below the rounding error of `units`.
  absl::Status Validate(const ColumnUnits& units) const;
};

// A node of `exact` keeps the value it has in `previous` where that is within the tolerance, else
// takes the exact one, rounded to `units`. Likewise map_from_mission, which is not rounded. Weights
// are rounded to float, stamps to units.stamp_ns. `previous` empty: everything is rounded.
MapGraph PublishedGraph(const MapGraph& exact, const MapGraph& previous,
                        const PublicationTolerance& tolerance, const ColumnUnits& units);

}  // namespace overtone

#endif  // OVERTONE_PROTO_CONVERSION_PUBLISHED_GRAPH_H_
