// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/normal_estimation.h"

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

Eigen::Vector3f ThinDirection(const Eigen::Matrix3d& scatter, SurfaceKind kind) {
  if (kind == SurfaceKind::kOutline) {
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> solver;
    solver.computeDirect(scatter.topLeftCorner<2, 2>());
    const Eigen::Vector2f normal = solver.eigenvectors().col(0).cast<float>();
    return Eigen::Vector3f(normal.x(), normal.y(), 0).normalized();
  }
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver;
  solver.computeDirect(scatter);
  return solver.eigenvectors().col(0).cast<float>().normalized();
}

}  // namespace

std::vector<Eigen::Vector3f> EstimateNormals(const std::vector<Eigen::Vector3f>& points,
                                             const KdTree& tree, int num_neighbors,
                                             SurfaceKind kind) {
  std::vector<Eigen::Vector3f> normals;
  normals.reserve(points.size());
  std::vector<int> neighbors(num_neighbors);
  for (const Eigen::Vector3f& point : points) {
    const int found = tree.Nearest(point, absl::MakeSpan(neighbors));
    const Eigen::Matrix3d scatter = Scatter(points, absl::MakeConstSpan(neighbors.data(), found));
    normals.push_back(ThinDirection(scatter, kind));
  }
  return normals;
}

}  // namespace overtone
