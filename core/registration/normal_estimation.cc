// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/normal_estimation.h"

#include <algorithm>

#include "Eigen/Eigenvalues"

namespace overtone {
namespace {

// n times the covariance of the points at `indices`.
Eigen::Matrix3d Scatter(const std::vector<Eigen::Vector3f>& points, absl::Span<const int> indices) {
  const Eigen::Vector3d origin = points[indices[0]].cast<double>();  // near: nothing cancels
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  for (const int index : indices) {
    const Eigen::Vector3d offset = points[index].cast<double>() - origin;
    sum += offset;
    squares += offset * offset.transpose();
  }
  return squares - sum * sum.transpose() / static_cast<double>(indices.size());
}

// How far two spreads are from being one, [0, 1].
double Distinctness(double least, double next) {
  return next > 0 ? std::clamp(1 - least / next, 0.0, 1.0) : 0;
}

SurfaceNormal OutlineNormal(const Eigen::Matrix3d& scatter) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
  solver.computeDirect(scatter.topLeftCorner<2, 2>());
  const Eigen::Vector2d spread = solver.eigenvalues(), direction = solver.eigenvectors().col(0);
  return {Eigen::Vector3d(direction.x(), direction.y(), 0).normalized().cast<float>(),
          static_cast<float>(Distinctness(spread(0), spread(1)))};
}

SurfaceNormal PlaneNormal(const Eigen::Matrix3d& scatter) {
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(scatter);
  const Eigen::Vector3d spread = solver.eigenvalues();
  return {solver.eigenvectors().col(0).normalized().cast<float>(),
          static_cast<float>(Distinctness(spread(0), spread(1)))};
}

}  // namespace

std::vector<SurfaceNormal> EstimateNormals(const std::vector<Eigen::Vector3f>& points,
                                           const KdTree& tree, int num_neighbors,
                                           SurfaceKind kind) {
  std::vector<SurfaceNormal> normals;
  normals.reserve(points.size());
  std::vector<int> neighbors(num_neighbors);
  for (const Eigen::Vector3f& point : points) {
    const int found = tree.Nearest(point, absl::MakeSpan(neighbors));
    const Eigen::Matrix3d scatter = Scatter(points, absl::MakeConstSpan(neighbors.data(), found));
    normals.push_back(kind == SurfaceKind::kOutline ? OutlineNormal(scatter)
                                                    : PlaneNormal(scatter));
  }
  return normals;
}

}  // namespace overtone
