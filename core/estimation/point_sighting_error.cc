// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/point_sighting_error.h"

namespace overtone {
namespace {

using PointByPose = Eigen::Matrix<double, 3, kPoseBlockSize, Eigen::RowMajor>;
using PointByPoint = Eigen::Matrix<double, 3, kPointBlockSize, Eigen::RowMajor>;

// a * [I, -Skew(point)]: how a * (T * point) moves with T, where a takes the pose's axes.
void WritePoseJacobian(const Eigen::Matrix3d& a, const Eigen::Vector3d& point, double* jacobian) {
  Eigen::Map<PointByPose> lifted(jacobian);
  lifted.leftCols<3>() = a;
  lifted.middleCols<3>(3) = -a * Skew(point);
  lifted.col(6).setZero();
}

}  // namespace

bool LandmarkSightingError::Evaluate(double const* const* parameters, double* residuals,
                                     double** jacobians) const {
  const Rigid3d pose_from_world = ReadPoseBlock(parameters[0]).Inverse();
  const Eigen::Vector3d point = pose_from_world * Eigen::Map<const Eigen::Vector3d>(parameters[1]);
  Eigen::Map<Eigen::Vector3d>{residuals} = square_root_information_ * (point - point_in_pose_);
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) WritePoseJacobian(-square_root_information_, point, jacobians[0]);
  if (jacobians[1] != nullptr) {
    Eigen::Map<PointByPoint>{jacobians[1]} =
        square_root_information_ * pose_from_world.rotation.toRotationMatrix();
  }
  return true;
}

bool CarriedPointSightingError::Evaluate(double const* const* parameters, double* residuals,
                                         double** jacobians) const {
  const Rigid3d pose_from_target =
      ReadPoseBlock(parameters[0]).Inverse() * ReadPoseBlock(parameters[1]);
  const Eigen::Vector3d point = pose_from_target * point_in_target_;
  Eigen::Map<Eigen::Vector3d>{residuals} = square_root_information_ * (point - point_in_pose_);
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) WritePoseJacobian(-square_root_information_, point, jacobians[0]);
  if (jacobians[1] != nullptr) {
    WritePoseJacobian(square_root_information_ * pose_from_target.rotation.toRotationMatrix(),
                      point_in_target_, jacobians[1]);
  }
  return true;
}

}  // namespace overtone
