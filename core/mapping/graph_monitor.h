// SPDX-License-Identifier: Apache-2.0
// The graph that robots receive, from a frozen map: keyframes thinned out by distance and rotation,
// then, above a node limit, by Kron reduction. Bernreiter et al. 2024, "Graph Monitor".
#ifndef OVERTONE_CORE_MAPPING_GRAPH_MONITOR_H_
#define OVERTONE_CORE_MAPPING_GRAPH_MONITOR_H_

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/graph/map_graph.h"
#include "overtone/core/mapping/map_snapshot.h"
#include "overtone/core/spectral/edge_weights.h"

namespace overtone {

struct GraphMonitorOptions {
  // A keyframe becomes a node when it is this far from the mission's last node, or turned this
  // much. 0: every one does.
  double min_distance_m = 0.4;
  double min_rotation_rad = 0.3;
  // Above it nodes are eliminated, but never the first and last of a mission nor the only one of a
  // connected part of the radius graph: for these the limit gives way.
  int max_nodes = 2000;
  // Sparsified Kron reduction: a new edge lighter than this share of the smaller of its ends'
  // degrees is not made.
  double reduction_tolerance = 1e-3;
  // The graph that is reduced, and whose edges are sent.
  RadiusGraphOptions radius_graph;
  // False: the receiver rebuilds the edges from the poses.
  bool include_edges = false;

  absl::Status Validate() const;
};

// Pure: the same snapshot and options give the same graph. Nodes are thinned out on the odometry as
// uploaded, so a mission's nodes stay the same from one revision to the next but for its last, as
// long as nothing is eliminated. Missions of different components share no edge: their frames have
// nothing to do with each other. InvalidArgument: as by Validate.
absl::StatusOr<MapGraph> BuildMapGraph(const MapSnapshot& snapshot,
                                       const GraphMonitorOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_GRAPH_MONITOR_H_
