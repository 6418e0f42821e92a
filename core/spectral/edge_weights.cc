// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/edge_weights.h"

#include <algorithm>
#include <cmath>
#include <numeric>
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
  const double along = (a.rotation * a_from_b.vec()).dot(offset) / sine;
  const double squared_across = std::max(0.0, squared_offset - along * along);
  const double stretch = half_angle * a_from_b.norm() / sine;  // angle / 2 over its sine
  return {std::copysign(2 * half_angle / sine, a_from_b.w()) * a_from_b.vec(),
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

// Node pairs i < j with their weights, by i, then by j.
struct WeightedPairs {
  std::vector<int64_t> begin = {0};  // those of i are [begin[i], begin[i + 1])
  std::vector<int> second;           // j
  std::vector<double> weight;        // > 0
};

absl::StatusOr<WeightedPairs> PairsWithinRadius(const std::vector<Rigid3d>& poses,
                                                const RadiusGraphOptions& options) {
  const PointCloud cloud{poses};
  const KdTree tree(/*dimensionality=*/3, cloud);
  // nanoflann's ball is open, and its squared distance rounds: search wider, then test exactly.
  const double squared_search_radius = options.radius_m * options.radius_m * (1 + 1e-9);
  std::vector<std::pair<int, double>> found;
  std::vector<int> above;
  WeightedPairs pairs;
  for (int i = 0; i < static_cast<int>(poses.size()); ++i) {
    tree.radiusSearch(poses[i].translation.data(), squared_search_radius, found,
                      nanoflann::SearchParams(/*checks_=*/0, /*eps_=*/0, /*sorted_=*/false));
    above.clear();
    for (const auto& [j, squared_distance] : found) {
      if (j > i && std::sqrt(squared_distance) <= options.radius_m) above.push_back(j);
    }
    if (2 * (pairs.second.size() + above.size()) > kMaxStoredWeights) {
      return absl::ResourceExhaustedError(absl::StrCat("radius graph: more than ",
                                                       kMaxStoredWeights / 2, " edges among ",
                                                       poses.size(), " poses"));
    }
    std::sort(above.begin(), above.end());
    for (const int j : above) {
      const double weight = EdgeWeight(poses[i], poses[j], options);
      if (!(weight > 0)) continue;  // underflow, or orthogonal rotations
      pairs.second.push_back(j);
      pairs.weight.push_back(weight);
    }
    pairs.begin.push_back(pairs.second.size());
  }
  return pairs;
}

SparseMatrix SymmetricMatrix(const WeightedPairs& pairs) {
  const int n = static_cast<int>(pairs.begin.size()) - 1;
  SparseMatrix matrix(n, n);
  matrix.resizeNonZeros(2 * pairs.second.size());
  int* const outer = matrix.outerIndexPtr();
  for (int i = 0; i < n; ++i) outer[i + 1] = static_cast<int>(pairs.begin[i + 1] - pairs.begin[i]);
  for (const int j : pairs.second) ++outer[j + 1];
  std::partial_sum(outer, outer + n + 1, outer);
  // Going through the pairs in order, every column receives its rows in increasing order.
  std::vector<int> end(outer, outer + n);
  const auto append = [&](int row, int column, double weight) {
    matrix.innerIndexPtr()[end[column]] = row;
    matrix.valuePtr()[end[column]++] = weight;
  };
  for (int i = 0; i < n; ++i) {
    for (int64_t p = pairs.begin[i]; p < pairs.begin[i + 1]; ++p) {
      append(i, pairs.second[p], pairs.weight[p]);
      append(pairs.second[p], i, pairs.weight[p]);
    }
  }
  return matrix;
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
  if (n < 2) return SparseMatrix(n, n);
  ASSIGN_OR_RETURN(const WeightedPairs pairs, PairsWithinRadius(poses, options));
  return SymmetricMatrix(pairs);
}

}  // namespace overtone
