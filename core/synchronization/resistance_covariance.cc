// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/resistance_covariance.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/spectral/graph_laplacian.h"

namespace overtone {
namespace {

absl::StatusOr<EffectiveResistance> Network(int num_nodes,
                                            const std::vector<InformationEdge>& edges,
                                            double InformationEdge::*information) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const InformationEdge& edge : edges) {
    entries.emplace_back(edge.first, edge.second, edge.*information);
    entries.emplace_back(edge.second, edge.first, edge.*information);
  }
  SparseMatrix adjacency(num_nodes, num_nodes);
  adjacency.setFromTriplets(entries.begin(), entries.end());
  return EffectiveResistance::Create(GraphLaplacian(adjacency));
}

bool IsValid(const InformationEdge& edge, int num_nodes) {
  const auto is_node = [num_nodes](int node) { return node >= 0 && node < num_nodes; };
  const auto is_information = [](double value) { return value > 0 && std::isfinite(value); };
  return is_node(edge.first) && is_node(edge.second) && edge.first != edge.second &&
         is_information(edge.translation) && is_information(edge.rotation);
}

}  // namespace

ResistanceCovariance::ResistanceCovariance(const std::vector<Rigid3d>& poses,
                                           const std::vector<InformationEdge>& edges,
                                           EffectiveResistance translation,
                                           EffectiveResistance rotation)
    : poses_(poses),
      edges_(edges),
      translation_(std::move(translation)),
      rotation_(std::move(rotation)) {}

absl::StatusOr<ResistanceCovariance> ResistanceCovariance::Create(
    const std::vector<Rigid3d>& poses, const std::vector<InformationEdge>& edges) {
  const int num_nodes = static_cast<int>(poses.size());
  for (size_t e = 0; e < edges.size(); ++e) {
    if (IsValid(edges[e], num_nodes)) continue;
    return absl::InvalidArgumentError(absl::StrCat("edges[", e, "]: not a valid edge"));
  }
  ASSIGN_OR_RETURN(EffectiveResistance translation,
                   Network(num_nodes, edges, &InformationEdge::translation));
  ASSIGN_OR_RETURN(EffectiveResistance rotation,
                   Network(num_nodes, edges, &InformationEdge::rotation));
  return ResistanceCovariance(poses, edges, std::move(translation), std::move(rotation));
}

absl::StatusOr<Matrix6d> ResistanceCovariance::Covariance(int from, int to) const {
  if (!std::isfinite(translation_.Between(from, to))) {
    return absl::FailedPreconditionError(
        absl::StrCat("no measurements lead from ", from, " to ", to));
  }
  const Eigen::VectorXd u_t = translation_.Potentials(from, to);
  const Eigen::VectorXd u_r = rotation_.Potentials(from, to);
  const Rigid3d to_from_map = poses_[to].Inverse();
  Matrix6d covariance = Matrix6d::Zero();
  for (const InformationEdge& edge : edges_) {
    const double f_t = (u_t[edge.first] - u_t[edge.second]) * edge.translation;
    const double f_r = (u_r[edge.first] - u_r[edge.second]) * edge.rotation;
    const Eigen::Matrix3d lever = Skew(to_from_map * poses_[edge.second].translation);
    covariance.topLeftCorner<3, 3>() += f_t * f_t / edge.rotation * lever * lever.transpose();
    covariance.topRightCorner<3, 3>() += f_t * f_r / edge.rotation * lever;
  }
  covariance.bottomLeftCorner<3, 3>() = covariance.topRightCorner<3, 3>().transpose();
  covariance.diagonal().head<3>().array() += u_t[from] - u_t[to];
  covariance.diagonal().tail<3>().array() += u_r[from] - u_r[to];
  return covariance;
}

}  // namespace overtone
