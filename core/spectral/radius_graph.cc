// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/radius_graph.h"

#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>

#include "absl/status/status.h"
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

absl::Status CheckArguments(const std::vector<Rigid3d>& poses, const RadiusGraphOptions& options) {
  RETURN_IF_ERROR(options.Validate());
  for (size_t i = 0; i < poses.size(); ++i) {
    if (!IsFinite(poses[i])) {
      return absl::InvalidArgumentError(absl::StrCat("poses[", i, "]: not finite"));
    }
  }
  return absl::OkStatus();
}

// Node pairs i < j within the radius, by i; the j of one i in no order.
struct Pairs {
  std::vector<int64_t> begin = {0};  // those of i are [begin[i], begin[i + 1])
  std::vector<int> second;           // j
};

absl::StatusOr<Pairs> PairsWithinRadius(const std::vector<Rigid3d>& poses, double radius_m) {
  if (poses.size() < 2) return Pairs{std::vector<int64_t>(poses.size() + 1, 0), {}};
  const PointCloud cloud{poses};
  const KdTree tree(/*dimensionality=*/3, cloud);
  // nanoflann's ball is open, and its squared distance rounds: search wider, then test exactly.
  const double squared_search_radius = radius_m * radius_m * (1 + 1e-9);
  std::vector<std::pair<int, double>> found;
  Pairs pairs;
  for (int i = 0; i < static_cast<int>(poses.size()); ++i) {
    tree.radiusSearch(poses[i].translation.data(), squared_search_radius, found,
                      nanoflann::SearchParams(/*checks_=*/0, /*eps_=*/0, /*sorted_=*/false));
    for (const auto& [j, squared_distance] : found) {
      if (j > i && std::sqrt(squared_distance) <= radius_m) pairs.second.push_back(j);
    }
    if (2 * static_cast<int64_t>(pairs.second.size()) > kMaxStoredWeights) {
      return absl::ResourceExhaustedError(absl::StrCat("radius graph: more than ",
                                                       kMaxStoredWeights / 2, " edges among ",
                                                       poses.size(), " poses"));
    }
    pairs.begin.push_back(pairs.second.size());
  }
  return pairs;
}

// Column by column in step with the nodes: when node i's turn comes, its column holds its weights
// to all nodes before it, which it passes on to theirs; then its own entry; then the nodes behind
// it get their weights to i. So every column receives its rows in increasing order, unsorted as the
// pairs are.
class Assembly {
 public:
  Assembly(const Pairs& pairs, bool with_diagonal) : with_diagonal_(with_diagonal) {
    const int n = static_cast<int>(pairs.begin.size()) - 1;
    matrix_.resize(n, n);
    int* const outer = matrix_.outerIndexPtr();
    for (int i = 0; i < n; ++i) {
      outer[i + 1] = static_cast<int>(pairs.begin[i + 1] - pairs.begin[i]) + with_diagonal;
    }
    for (const int j : pairs.second) ++outer[j + 1];
    std::partial_sum(outer, outer + n + 1, outer);
    matrix_.resizeNonZeros(outer[n]);
    end_.assign(outer, outer + n);
  }

  void PassOnAndMarkDiagonal(int i) {
    const int begin = matrix_.outerIndexPtr()[i], end = end_[i];
    for (int k = begin; k < end; ++k) {
      Append(i, matrix_.innerIndexPtr()[k], matrix_.valuePtr()[k]);
    }
    if (with_diagonal_) Append(i, i, 0);
  }
  void Append(int row, int column, double value) {
    matrix_.innerIndexPtr()[end_[column]] = row;
    matrix_.valuePtr()[end_[column]++] = value;
  }

  SparseMatrix Take() { return std::move(matrix_); }

 private:
  const bool with_diagonal_;
  SparseMatrix matrix_;
  std::vector<int> end_;  // of what each column holds so far
};

// sign * weight off the diagonal; on it, where asked for, 0.
absl::StatusOr<SparseMatrix> SignedWeights(const std::vector<Rigid3d>& poses,
                                           const RadiusGraphOptions& options, double sign,
                                           bool with_diagonal) {
  RETURN_IF_ERROR(CheckArguments(poses, options));
  ASSIGN_OR_RETURN(const Pairs pairs, PairsWithinRadius(poses, options.radius_m));
  Assembly assembly(pairs, with_diagonal);
  bool any_zero = false;  // underflow, or orthogonal rotations
  for (int i = 0; i < static_cast<int>(poses.size()); ++i) {
    assembly.PassOnAndMarkDiagonal(i);
    for (int64_t p = pairs.begin[i]; p < pairs.begin[i + 1]; ++p) {
      const double weight = EdgeWeight(poses[i], poses[pairs.second[p]], options);
      any_zero = any_zero || !(weight > 0);
      assembly.Append(i, pairs.second[p], sign * weight);
    }
  }
  SparseMatrix matrix = assembly.Take();
  if (any_zero) {
    matrix.prune([](Eigen::Index row, Eigen::Index column, double value) {
      return row == column || std::abs(value) > 0;
    });
  }
  return matrix;
}

}  // namespace

absl::StatusOr<SparseMatrix> RadiusGraphAdjacency(const std::vector<Rigid3d>& poses,
                                                  const RadiusGraphOptions& options) {
  return SignedWeights(poses, options, /*sign=*/1, /*with_diagonal=*/false);
}

absl::StatusOr<SparseMatrix> RadiusGraphLaplacian(const std::vector<Rigid3d>& poses,
                                                  const RadiusGraphOptions& options) {
  ASSIGN_OR_RETURN(SparseMatrix laplacian,
                   SignedWeights(poses, options, /*sign=*/-1, /*with_diagonal=*/true));
  for (int column = 0; column < laplacian.cols(); ++column) {
    double sum = 0, *diagonal = nullptr;
    for (SparseMatrix::InnerIterator entry(laplacian, column); entry; ++entry) {
      sum += entry.value();
      if (entry.row() == column) diagonal = &entry.valueRef();
    }
    *diagonal = -sum;
  }
  return laplacian;
}

}  // namespace overtone
