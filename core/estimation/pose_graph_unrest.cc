// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/pose_graph_unrest.h"

#include <utility>

#include "Eigen/Cholesky"

namespace overtone {
namespace {

using PointByPose = Eigen::Matrix<double, 3, 6>;

// How T * point, in axes `axes`, moves with T on its right.
PointByPose MovedPoint(const Eigen::Matrix3d& axes, const Eigen::Vector3d& point) {
  PointByPose jacobian;
  jacobian << axes, -axes * Skew(point);
  return jacobian;
}

}  // namespace

PoseGraphUnrest::PoseGraphUnrest(const PoseGraph& graph, std::vector<double> weights)
    : graph_(graph),
      weights_(std::move(weights)),
      chi_squares_(weights_.size(), 0),
      counted_(weights_.size()),
      gradients_(graph.poses.size() + graph.landmarks.size(), Vector6d::Zero()),
      hessians_(gradients_.size(), Matrix6d::Zero()) {}

// relative_pose_error.h has the Jacobians.
PoseGraphUnrest::Pull PoseGraphUnrest::PullOf(const PoseGraphEdge& edge,
                                              const std::vector<Rigid3d>& poses) const {
  Pull pull;
  const Rigid3d from_tform_to = poses[edge.from].Inverse() * poses[edge.to];
  const Vector6d error = Log(edge.from_tform_to.Inverse() * from_tform_to);
  const Vector6d force = edge.information * error;
  const Matrix6d by_to = InverseRightJacobian(error);
  const Matrix6d adjoint = Adjoint(from_tform_to.Inverse());
  pull.chi_square = error.dot(force);
  pull.gradient[1] = by_to.transpose() * force;
  pull.gradient[0] = -adjoint.transpose() * pull.gradient[1];
  pull.hessian[1] = by_to.transpose() * edge.information * by_to;
  pull.hessian[0] = adjoint.transpose() * pull.hessian[1] * adjoint;
  return pull;
}

// point_sighting_error.h has the Jacobians.
PoseGraphUnrest::Pull PoseGraphUnrest::PullOf(const PointSighting& sighting,
                                              const std::vector<Rigid3d>& poses,
                                              const std::vector<Eigen::Vector3d>& landmarks) const {
  Pull pull;
  const Rigid3d pose_from_world = poses[sighting.pose].Inverse();
  const bool is_landmark = sighting.landmark >= 0;
  const Rigid3d pose_from_target =
      is_landmark ? pose_from_world : pose_from_world * poses[sighting.target_pose];
  const Eigen::Vector3d& carried =
      is_landmark ? landmarks[sighting.landmark] : sighting.point_in_target;
  const Eigen::Vector3d point = pose_from_target * carried;
  const Eigen::Vector3d error = point - sighting.point_in_pose;
  const Eigen::Vector3d force = sighting.information * error;
  const Eigen::Matrix3d axes = pose_from_target.rotation.toRotationMatrix();
  PointByPose by_target = MovedPoint(axes, carried);
  if (is_landmark) by_target.rightCols<3>().setZero();
  const PointByPose by_pose = -MovedPoint(Eigen::Matrix3d::Identity(), point);
  pull.chi_square = error.dot(force);
  pull.gradient[0] = by_pose.transpose() * force;
  pull.gradient[1] = by_target.transpose() * force;
  pull.hessian[0] = by_pose.transpose() * sighting.information * by_pose;
  pull.hessian[1] = by_target.transpose() * sighting.information * by_target;
  return pull;
}

void PoseGraphUnrest::Update(int measurement, const std::vector<Rigid3d>& poses,
                             const std::vector<Eigen::Vector3d>& landmarks) {
  const int num_edges = static_cast<int>(graph_.edges.size());
  const int num_poses = static_cast<int>(graph_.poses.size());
  Pull pull;
  int ends[2];
  if (measurement < num_edges) {
    const PoseGraphEdge& edge = graph_.edges[measurement];
    pull = PullOf(edge, poses);
    ends[0] = edge.from;
    ends[1] = edge.to;
  } else {
    const PointSighting& sighting = graph_.sightings[measurement - num_edges];
    pull = PullOf(sighting, poses, landmarks);
    ends[0] = sighting.pose;
    ends[1] = sighting.landmark >= 0 ? num_poses + sighting.landmark : sighting.target_pose;
  }
  const double weight = weights_[measurement];
  Counted& counted = counted_[measurement];
  chi_squares_[measurement] = pull.chi_square;
  for (int end = 0; end < 2; ++end) {
    gradients_[ends[end]] += weight * pull.gradient[end] - counted.of_ends[end];
    counted.of_ends[end] = weight * pull.gradient[end];
    if (!counted.is_counted) hessians_[ends[end]] += weight * pull.hessian[end];
  }
  counted.is_counted = true;
}

double PoseGraphUnrest::GainAlone(int variable) const {
  const Vector6d& gradient = gradients_[variable];
  if (gradient.isZero(0)) return 0;
  const Matrix6d& hessian = hessians_[variable];
  // A direction that nothing measures (a landmark's last three rows) has no gradient either.
  const double floor = 1e-12 * hessian.trace();
  return 0.5 * gradient.dot((hessian + floor * Matrix6d::Identity()).ldlt().solve(gradient));
}

double PoseGraphUnrest::Cost() const {
  double cost = 0;
  for (size_t k = 0; k < weights_.size(); ++k) cost += 0.5 * weights_[k] * chi_squares_[k];
  return cost;
}

}  // namespace overtone
