// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/graph_monitor.h"

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "overtone/core/common/status_macros.h"
#include "overtone/core/graph/node_selection.h"
#include "overtone/core/spectral/graph_laplacian.h"
#include "overtone/core/spectral/kron_reduction.h"
#include "overtone/core/spectral/reduction_node_selection.h"

namespace overtone {
namespace {

KeyframeSelectionOptions KeyframingOf(const GraphMonitorOptions& options) {
  return {options.min_distance_m, options.min_rotation_rad};
}

// Kept keyframe indices of each mission of the snapshot, increasing.
using KeptKeyframes = std::vector<std::vector<int>>;

KeptKeyframes ThinOut(const MapSnapshot& snapshot, const GraphMonitorOptions& options) {
  KeptKeyframes kept;
  for (const SnapshotMission& mission : snapshot.missions) {
    std::vector<Rigid3d> odometry;
    for (const Keyframe& keyframe : mission.keyframes) {
      odometry.push_back(keyframe.mission_from_body);
    }
    kept.push_back(SelectKeyframes(odometry, KeyframingOf(options)));
  }
  return kept;
}

// A node answers for all keyframes since the one before it.
std::vector<MapNode> MakeNodes(const SnapshotMission& mission, const std::vector<int>& kept) {
  std::vector<MapNode> nodes;
  auto submap_start = mission.submap_starts.begin();
  int next = 0;
  for (const int index : kept) {
    MapNode& node = nodes.emplace_back();
    node.index = index;
    node.stamp = mission.keyframes[index].stamp;
    node.map_from_body = mission.map_from_body[index];
    for (; next <= index; ++next) node.degenerate |= mission.keyframes[next].degenerate;
    for (; submap_start != mission.submap_starts.end() && *submap_start <= index; ++submap_start) {
      node.submap_start = true;
    }
  }
  return nodes;
}

MapGraph MakeGraph(const MapSnapshot& snapshot, const KeptKeyframes& kept) {
  MapGraph graph;
  graph.revision = snapshot.revision;
  graph.map_epoch = snapshot.map_epoch;
  for (size_t m = 0; m < snapshot.missions.size(); ++m) {
    const SnapshotMission& mission = snapshot.missions[m];
    graph.missions.push_back({mission.id, mission.anchored, mission.component,
                              mission.map_from_mission, MakeNodes(mission, kept[m])});
  }
  return graph;
}

// Over the concatenation of all missions' nodes; one radius graph for each component.
absl::StatusOr<SparseMatrix> Adjacency(const MapGraph& graph, const RadiusGraphOptions& options) {
  struct Component {
    std::vector<Rigid3d> poses;
    std::vector<int> positions;
  };
  std::map<int, Component> components;
  int position = 0;
  for (const MapMission& mission : graph.missions) {
    Component& component = components[mission.component];
    for (const MapNode& node : mission.nodes) {
      component.poses.push_back(node.map_from_body);
      component.positions.push_back(position++);
    }
  }
  std::vector<Eigen::Triplet<double>> triplets;
  for (const auto& [number, component] : components) {
    ASSIGN_OR_RETURN(const SparseMatrix adjacency, RadiusGraphAdjacency(component.poses, options));
    for (int column = 0; column < adjacency.outerSize(); ++column) {
      for (SparseMatrix::InnerIterator entry(adjacency, column); entry; ++entry) {
        triplets.emplace_back(component.positions[entry.row()], component.positions[column],
                              entry.value());
      }
    }
  }
  SparseMatrix adjacency(position, position);
  adjacency.setFromTriplets(triplets.begin(), triplets.end());
  return adjacency;
}

// Off its diagonal a Laplacian holds the negative weights. The lower triangle by columns: first
// increasing, then second.
std::vector<MapEdge> EdgesOf(const SparseMatrix& laplacian) {
  std::vector<MapEdge> edges;
  for (int column = 0; column < laplacian.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(laplacian, column); entry; ++entry) {
      if (entry.row() > column && entry.value() < 0) {
        edges.push_back({column, static_cast<int>(entry.row()), -entry.value()});
      }
    }
  }
  return edges;
}

// Positions, in the concatenation of all missions' nodes, of each mission's first and last.
std::vector<int> EndsOfMissions(const KeptKeyframes& kept) {
  std::vector<int> ends;
  int begin = 0;
  for (const std::vector<int>& mission : kept) {
    const int end = begin + static_cast<int>(mission.size());
    if (end == begin) continue;
    ends.push_back(begin);
    if (end - 1 > begin) ends.push_back(end - 1);
    begin = end;
  }
  return ends;
}

KeptKeyframes Select(const KeptKeyframes& kept, const std::vector<int>& positions) {
  KeptKeyframes selected(kept.size());
  auto position = positions.begin();
  int begin = 0;
  for (size_t m = 0; m < kept.size(); ++m) {
    const int end = begin + static_cast<int>(kept[m].size());
    for (; position != positions.end() && *position < end; ++position) {
      selected[m].push_back(kept[m][*position - begin]);
    }
    begin = end;
  }
  return selected;
}

absl::StatusOr<MapGraph> Reduce(const MapSnapshot& snapshot, const KeptKeyframes& kept,
                                const SparseMatrix& laplacian, const GraphMonitorOptions& options) {
  ASSIGN_OR_RETURN(const std::vector<int> positions,
                   SelectNodes(laplacian, options.max_nodes, EndsOfMissions(kept), {}));
  MapGraph graph = MakeGraph(snapshot, Select(kept, positions));
  if (!options.include_edges) return graph;
  ASSIGN_OR_RETURN(const KronReductionResult reduced,
                   SparsifiedKronReduction(laplacian, positions, options.reduction_tolerance));
  graph.edges = EdgesOf(reduced.laplacian);
  return graph;
}

}  // namespace

absl::Status GraphMonitorOptions::Validate() const {
  RETURN_IF_ERROR(KeyframingOf(*this).Validate());
  if (max_nodes < 1) return absl::InvalidArgumentError("max_nodes must be at least 1");
  if (!(reduction_tolerance >= 0 && reduction_tolerance < 1)) {
    return absl::InvalidArgumentError("reduction_tolerance must be in [0, 1)");
  }
  return radius_graph.Validate();
}

absl::StatusOr<MapGraph> BuildMapGraph(const MapSnapshot& snapshot,
                                       const GraphMonitorOptions& options) {
  RETURN_IF_ERROR(options.Validate());
  const KeptKeyframes kept = ThinOut(snapshot, options);
  MapGraph graph = MakeGraph(snapshot, kept);
  const bool reduce = graph.NumNodes() > options.max_nodes;
  if (!reduce && !options.include_edges) return graph;
  ASSIGN_OR_RETURN(const SparseMatrix adjacency, Adjacency(graph, options.radius_graph));
  const SparseMatrix laplacian = GraphLaplacian(adjacency);
  if (reduce) return Reduce(snapshot, kept, laplacian, options);
  graph.edges = EdgesOf(laplacian);
  return graph;
}

}  // namespace overtone
