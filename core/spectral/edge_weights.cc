// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/edge_weights.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "nanoflann.hpp"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

constexpr int64_t kMaxStoredWeights = 60'000'000;  // two per edge

struct PointCloud {
  const std::vector<Rigid3d>& poses;

  size_t kdtree_get_point_count() const { return poses.size(); }
  double kdtree_get_pt(size_t index, size_t axis) const { return poses[index].translation[axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using KdTree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointCloud>,
                                                   PointCloud, /*DIM=*/3, /*IndexType=*/int>;

// phi and |rho|^2 of Log(a^-1 b) = [rho; phi].
struct LogLengths {
  Eigen::Vector3d phi;
  double squared_rho;
};

// rho = V(phi)^-1 t. V keeps the part of t along the axis and, across it, turns t and scales it by
// sin(angle / 2) / (angle / 2). Barfoot, State Estimation for Robotics, 7.1.3.
LogLengths RelativeLog(const Rigid3d& a, const Rigid3d& b) {
  const Eigen::Quaterniond a_from_b = a.rotation.conjugate() * b.rotation;
  const double sine = a_from_b.vec().norm();
  const double half_angle = std::atan2(sine, std::abs(a_from_b.w()));
  const Eigen::Vector3d offset = b.translation - a.translation;
  const double squared_offset = offset.squaredNorm();
  if (sine < 1e-9) return {2 * std::copysign(1.0, a_from_b.w()) * a_from_b.vec(), squared_offset};
  const Eigen::Vector3d axis = a_from_b.vec() / sine;
  const double along = (a.rotation * axis).dot(offset);
  const double squared_across = std::max(0.0, squared_offset - along * along);
  const double stretch = half_angle / std::sin(half_angle);
  return {2 * std::copysign(half_angle, a_from_b.w()) * axis,
          along * along + stretch * stretch * squared_across};
}

// tr(Xi M Xi^T) is the sum over Xi's columns of weight times squared length.
double Se3Distance(const Rigid3d& a, const Rigid3d& b, const Eigen::Vector4d& m) {
  const LogLengths log = RelativeLog(a, b);
  const Eigen::Vector3d phi2 = log.phi.cwiseAbs2();
  return std::sqrt(m[0] * (phi2.y() + phi2.z()) + m[1] * (phi2.x() + phi2.z()) +
                   m[2] * (phi2.x() + phi2.y()) + m[3] * log.squared_rho);
}

double EdgeWeight(const Rigid3d& a, const Rigid3d& b, const RadiusGraphOptions& options) {
  const double distance = PoseDistance(a, b, options.metric, options.weights);
  if (options.metric == DistanceMetric::kSo3Trace) return std::abs(distance);
  return std::exp(-distance / (2 * options.sigma * options.sigma));
}

// Squares of coordinates and of their differences stay finite below this.
bool IsFinite(const Rigid3d& pose) {
  return pose.rotation.coeffs().allFinite() && pose.translation.allFinite() &&
         pose.translation.lpNorm<Eigen::Infinity>() < 1e150;
}

// For each node its neighbours of higher index, increasing.
absl::StatusOr<std::vector<std::vector<int>>> NeighborsAbove(const std::vector<Rigid3d>& poses,
                                                             double radius) {
  const PointCloud cloud{poses};
  const KdTree tree(/*dimensionality=*/3, cloud);
  // nanoflann's ball is open, and its squared distance rounds: search wider, then test exactly.
  const double squared_search_radius = radius * radius * (1 + 1e-9);
  std::vector<std::pair<int, double>> found;
  std::vector<std::vector<int>> above(poses.size());
  int64_t num_weights = 0;
  for (int i = 0; i < static_cast<int>(poses.size()); ++i) {
    tree.radiusSearch(poses[i].translation.data(), squared_search_radius, found,
                      nanoflann::SearchParams(/*checks_=*/0, /*eps_=*/0, /*sorted_=*/false));
    for (const auto& [j, squared_distance] : found) {
      if (j > i && (poses[i].translation - poses[j].translation).norm() <= radius) {
        above[i].push_back(j);
      }
    }
    std::sort(above[i].begin(), above[i].end());
    num_weights += 2 * static_cast<int64_t>(above[i].size());
    if (num_weights > kMaxStoredWeights) {
      return absl::ResourceExhaustedError(absl::StrCat("radius graph: more than ",
                                                       kMaxStoredWeights / 2, " edges among ",
                                                       poses.size(), " poses"));
    }
  }
  return above;
}

}  // namespace

MetricWeights PrototypeSignalWeights() { return {Eigen::Vector4d(10, 10, 0.001, 0.001)}; }

absl::Status RadiusGraphOptions::Validate() const {
  if (!(radius_m > 0) || !(radius_m < 1e150)) {
    return absl::InvalidArgumentError(
        absl::StrCat("radius_m: ", radius_m, " is not positive and finite"));
  }
  if (!(sigma > 0) || !std::isfinite(sigma)) {
    return absl::InvalidArgumentError(
        absl::StrCat("sigma: ", sigma, " is not positive and finite"));
  }
  if (!weights.diagonal.allFinite() || !(weights.diagonal.minCoeff() >= 0)) {
    return absl::InvalidArgumentError("weights.diagonal: not finite and non-negative");
  }
  return absl::OkStatus();
}

double PoseDistance(const Rigid3d& a, const Rigid3d& b, DistanceMetric metric,
                    const MetricWeights& weights) {
  switch (metric) {
    case DistanceMetric::kSe3:
      return Se3Distance(a, b, weights.diagonal);
    case DistanceMetric::kR3:
      return (b.translation - a.translation).norm();
    case DistanceMetric::kSo3: {
      const Eigen::Quaterniond a_from_b = a.rotation.conjugate() * b.rotation;
      return 2 * std::atan2(a_from_b.vec().norm(), std::abs(a_from_b.w()));
    }
    case DistanceMetric::kSo3Trace:
      return 3 - 4 * (a.rotation.conjugate() * b.rotation).vec().squaredNorm();
  }
  return 0;
}

absl::StatusOr<SparseMatrix> RadiusGraphAdjacency(const std::vector<Rigid3d>& poses,
                                                  const RadiusGraphOptions& options) {
  RETURN_IF_ERROR(options.Validate());
  const int n = static_cast<int>(poses.size());
  for (int i = 0; i < n; ++i) {
    if (!IsFinite(poses[i])) {
      return absl::InvalidArgumentError(absl::StrCat("poses[", i, "]: not finite"));
    }
  }
  SparseMatrix adjacency(n, n);
  if (n < 2) return adjacency;
  ASSIGN_OR_RETURN(const std::vector<std::vector<int>> above,
                   NeighborsAbove(poses, options.radius_m));

  Eigen::VectorXi degree = Eigen::VectorXi::Zero(n);
  for (int i = 0; i < n; ++i) {
    degree[i] += static_cast<int>(above[i].size());
    for (const int j : above[i]) ++degree[j];
  }
  adjacency.reserve(degree);
  // Going through the pairs in increasing order, every column receives its rows in increasing
  // order.
  for (int i = 0; i < n; ++i) {
    for (const int j : above[i]) {
      const double weight = EdgeWeight(poses[i], poses[j], options);
      if (!(weight > 0)) continue;  // underflow, or orthogonal rotations
      adjacency.insert(i, j) = weight;
      adjacency.insert(j, i) = weight;
    }
  }
  adjacency.makeCompressed();
  return adjacency;
}

}  // namespace overtone
