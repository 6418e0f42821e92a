// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/relative_pose_error.h"

namespace overtone {
namespace {

using PoseJacobian = Eigen::Matrix<double, 6, kPoseBlockSize, Eigen::RowMajor>;

}  // namespace

void WritePoseBlock(const Rigid3d& pose, double* block) {
  Eigen::Map<Eigen::Quaterniond>{block} = pose.rotation;
  Eigen::Map<Eigen::Vector3d>{block + 4} = pose.translation;
}

Rigid3d ReadPoseBlock(const double* block) {
  return Rigid3d(Eigen::Map<const Eigen::Quaterniond>(block),
                 Eigen::Map<const Eigen::Vector3d>(block + 4));
}

bool PoseManifold::Plus(const double* x, const double* delta, double* x_plus_delta) const {
  Rigid3d pose = ReadPoseBlock(x) * Exp(Eigen::Map<const Vector6d>(delta));
  WritePoseBlock(pose, x_plus_delta);
  return true;
}

bool PoseManifold::PlusJacobian(const double* /*x*/, double* jacobian) const {
  Eigen::Map<Eigen::Matrix<double, kPoseBlockSize, 6, Eigen::RowMajor>>(jacobian).setIdentity();
  return true;
}

bool PoseManifold::Minus(const double* y, const double* x, double* y_minus_x) const {
  Eigen::Map<Vector6d>{y_minus_x} = Log(ReadPoseBlock(x).Inverse() * ReadPoseBlock(y));
  return true;
}

bool PoseManifold::MinusJacobian(const double* /*x*/, double* jacobian) const {
  Eigen::Map<PoseJacobian>(jacobian).setIdentity();
  return true;
}

bool RelativePoseError::Evaluate(double const* const* parameters, double* residuals,
                                 double** jacobians) const {
  const Rigid3d i_from_j = ReadPoseBlock(parameters[0]).Inverse() * ReadPoseBlock(parameters[1]);
  const Vector6d error = Log(to_tform_from_ * i_from_j);
  Eigen::Map<Vector6d>{residuals} = square_root_information_ * error;
  if (jacobians == nullptr) return true;
  const Matrix6d by_j = square_root_information_ * InverseRightJacobian(error);
  if (jacobians[0] != nullptr) {
    Eigen::Map<PoseJacobian> jacobian(jacobians[0]);
    jacobian.leftCols<6>() = -by_j * Adjoint(i_from_j.Inverse());
    jacobian.col(6).setZero();
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<PoseJacobian> jacobian(jacobians[1]);
    jacobian.leftCols<6>() = by_j;
    jacobian.col(6).setZero();
  }
  return true;
}

double RelativePoseError::ChiSquare(const Rigid3d& world_from_i,
                                    const Rigid3d& world_from_j) const {
  const Vector6d error = Log(to_tform_from_ * (world_from_i.Inverse() * world_from_j));
  return (square_root_information_ * error).squaredNorm();
}

}  // namespace overtone
