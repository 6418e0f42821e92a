// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/wavelet_discrepancy.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/spectral/graph_laplacian.h"
#include "overtone/core/synchronization/trajectory_signal.h"

namespace overtone {
namespace {

constexpr int kMinCommonNodes = 3;

// The nodes psi lives on.
struct Domain {
  std::vector<Rigid3d> map_from_body;
  std::vector<int> node_of_row;       // row of the comparison -> position here
  std::vector<int> node_of_position;  // position in the concatenation of all missions' nodes ->
                                      // position here, or -1
};

const MapMission* FindMission(const MapGraph& graph, const MissionId& id) {
  for (const MapMission& mission : graph.missions) {
    if (mission.id == id) return &mission;
  }
  return nullptr;
}

TrajectoryComparison Associate(const MapGraph& graph, const MapMission& mission,
                               const std::vector<NodePose>& onboard,
                               const std::vector<NodeMatch>& matches) {
  TrajectoryComparison comparison;
  comparison.revision = graph.revision;
  comparison.map_epoch = graph.map_epoch;
  std::vector<bool> matched(onboard.size(), false);
  int next_node = 0;
  for (const NodeMatch& match : matches) {
    // A submap starts at its first associated node.
    bool submap_start = false;
    for (; next_node <= match.server; ++next_node) {
      submap_start = submap_start || mission.nodes[next_node].submap_start;
    }
    const MapNode& node = mission.nodes[match.server];
    matched[match.onboard] = true;
    comparison.keyframe_index.push_back(onboard[match.onboard].index);
    comparison.server.push_back(node.map_from_body);
    comparison.onboard.push_back(onboard[match.onboard].estimate_from_body);
    comparison.submap_start.push_back(submap_start);
    comparison.degenerate.push_back(node.degenerate);
  }
  for (int i = 0; i < onboard.size(); ++i) {
    if (!matched[i]) comparison.unmatched.push_back(onboard[i]);
  }
  return comparison;
}

Domain MakeDomain(const MapGraph& graph, const MapMission& own,
                  const std::vector<NodeMatch>& matches, bool multi_robot) {
  Domain domain;
  for (const MapMission& mission : graph.missions) {
    const size_t begin = domain.node_of_position.size();
    domain.node_of_position.resize(begin + mission.nodes.size(), -1);
    if (multi_robot && mission.component == own.component) {
      for (int i = 0; i < mission.nodes.size(); ++i) {
        domain.node_of_position[begin + i] = static_cast<int>(domain.map_from_body.size());
        domain.map_from_body.push_back(mission.nodes[i].map_from_body);
      }
    }
    if (&mission != &own) continue;
    for (const NodeMatch& match : matches) {
      int& node = domain.node_of_position[begin + match.server];
      if (!multi_robot) {
        node = static_cast<int>(domain.map_from_body.size());
        domain.map_from_body.push_back(own.nodes[match.server].map_from_body);
      }
      domain.node_of_row.push_back(node);
    }
  }
  return domain;
}

absl::StatusOr<SparseMatrix> AdjacencyFromEdges(const std::vector<MapEdge>& edges,
                                                const std::vector<int>& node_of_position,
                                                int num_nodes) {
  const int num_positions = static_cast<int>(node_of_position.size());
  std::vector<Eigen::Triplet<double>> weights;
  weights.reserve(2 * edges.size());
  for (int e = 0; e < edges.size(); ++e) {
    const MapEdge& edge = edges[e];
    if (edge.first < 0 || edge.first >= edge.second || edge.second >= num_positions ||
        !(edge.weight > 0) || !std::isfinite(edge.weight)) {
      return absl::InvalidArgumentError(absl::StrCat("graph.edges[", e, "]: not a valid edge"));
    }
    const int first = node_of_position[edge.first];
    const int second = node_of_position[edge.second];
    if (first < 0 || second < 0) continue;
    weights.emplace_back(first, second, edge.weight);
    weights.emplace_back(second, first, edge.weight);
  }
  SparseMatrix adjacency(num_nodes, num_nodes);
  adjacency.setFromTriplets(weights.begin(), weights.end());
  return adjacency;
}

}  // namespace

Band BandOfScale(int scale, int num_scales) { return static_cast<Band>(3 * scale / num_scales); }

Eigen::MatrixXd BandSums(const std::vector<Eigen::MatrixXd>& coefficients) {
  const int num_scales = static_cast<int>(coefficients.size());
  Eigen::MatrixXd sums = Eigen::MatrixXd::Zero(coefficients[0].rows(), 3);
  for (int s = 0; s < num_scales; ++s) {
    sums.col(static_cast<int>(BandOfScale(s, num_scales))) += coefficients[s].rowwise().norm();
  }
  return sums;
}

absl::StatusOr<Eigen::MatrixXd> WaveletDiscrepancy(const SparseMatrix& laplacian,
                                                   const Eigen::MatrixXd& signal_difference,
                                                   const WaveletOptions& options) {
  ASSIGN_OR_RETURN(const std::vector<Eigen::MatrixXd> coefficients,
                   WaveletCoefficients(laplacian, signal_difference, options));
  return BandSums(coefficients);
}

TrajectoryComparator::TrajectoryComparator(const SynchronizationOptions& options)
    : options_(options), filter_(options.graph, options.wavelets) {}

absl::StatusOr<Eigen::MatrixXd> TrajectoryComparator::Discrepancy(
    const MapGraph& graph, const std::vector<int>& node_of_position,
    const std::vector<Rigid3d>& nodes, const Eigen::MatrixXd& signal_difference) {
  if (graph.edges.empty()) return filter_.Filter(nodes, signal_difference);
  ASSIGN_OR_RETURN(
      const SparseMatrix adjacency,
      AdjacencyFromEdges(graph.edges, node_of_position, static_cast<int>(nodes.size())));
  const SparseMatrix laplacian = GraphLaplacian(adjacency);
  RETURN_IF_ERROR(CheckHasEdges(laplacian));
  return WaveletDiscrepancy(laplacian, signal_difference, options_.wavelets);
}

absl::StatusOr<TrajectoryComparison> TrajectoryComparator::Compare(
    const MapGraph& graph, const MissionId& mission, const std::vector<NodePose>& onboard) {
  RETURN_IF_ERROR(options_.Validate());
  const MapMission* own = FindMission(graph, mission);
  if (own == nullptr) {
    return absl::NotFoundError(absl::StrCat("graph: no mission ", ToString(mission)));
  }
  ASSIGN_OR_RETURN(const std::vector<NodePose> trajectory, CheckedTrajectory(onboard));
  const std::vector<NodeMatch> matches =
      AssociateNodes(*own, trajectory, options_.association_tolerance_s);
  if (matches.size() < kMinCommonNodes) {
    return absl::FailedPreconditionError(
        absl::StrCat("graph and trajectory: ", matches.size(), " nodes in common, 3 needed"));
  }
  TrajectoryComparison comparison = Associate(graph, *own, trajectory, matches);
  const Domain domain = MakeDomain(graph, *own, matches, options_.multi_robot_graph);
  const auto signal = [this](const std::vector<Rigid3d>& poses) {
    return TrajectorySignal(poses, options_.signal, options_.graph.metric, options_.signal_weights);
  };
  const Eigen::MatrixXd row_difference = signal(comparison.server) - signal(comparison.onboard);
  Eigen::MatrixXd difference =
      Eigen::MatrixXd::Zero(domain.map_from_body.size(), row_difference.cols());
  for (int row = 0; row < row_difference.rows(); ++row) {
    difference.row(domain.node_of_row[row]) = row_difference.row(row);
  }
  ASSIGN_OR_RETURN(const Eigen::MatrixXd discrepancy,
                   Discrepancy(graph, domain.node_of_position, domain.map_from_body, difference));
  comparison.discrepancy.resize(row_difference.rows(), 3);
  for (int row = 0; row < row_difference.rows(); ++row) {
    comparison.discrepancy.row(row) = discrepancy.row(domain.node_of_row[row]);
  }
  return comparison;
}

absl::StatusOr<TrajectoryComparison> CompareTrajectories(const MapGraph& graph,
                                                         const MissionId& mission,
                                                         const std::vector<NodePose>& onboard,
                                                         const SynchronizationOptions& options) {
  return TrajectoryComparator(options).Compare(graph, mission, onboard);
}

}  // namespace overtone
