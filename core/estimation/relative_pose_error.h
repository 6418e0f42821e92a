// SPDX-License-Identifier: Apache-2.0
// The residual of one measured relative pose, for Ceres, with analytic Jacobians on SE(3).
//
//     r = S * Log(Z^-1 * T_i^-1 * T_j),   S by square_root_information.h
//
// A pose is a block of 7 doubles, [qx qy qz qw tx ty tz], moved on the right: T <- T * Exp(delta),
// delta = [rho; phi]. With e = Log(Z^-1 T_i^-1 T_j) and Jr the right Jacobian of SE(3) (Barfoot,
// State Estimation for Robotics, 7.1.5):
//
//     dr/d delta_j =  S * Jr(e)^-1
//     dr/d delta_i = -S * Jr(e)^-1 * Adjoint(T_j^-1 * T_i)
#ifndef OVERTONE_CORE_ESTIMATION_RELATIVE_POSE_ERROR_H_
#define OVERTONE_CORE_ESTIMATION_RELATIVE_POSE_ERROR_H_

#include "ceres/manifold.h"
#include "ceres/sized_cost_function.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

constexpr int kPoseBlockSize = 7;

void WritePoseBlock(const Rigid3d& pose, double* block);
Rigid3d ReadPoseBlock(const double* block);

// SE(3) with right perturbations. Ceres needs only the product of a residual's Jacobian and
// PlusJacobian; both are written in the tangent directly: PlusJacobian is [I_6; 0], and the
// residual's Jacobian is [tangent Jacobian, 0]. Every cost function on a pose block must follow.
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return kPoseBlockSize; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override;
  bool PlusJacobian(const double* x, double* jacobian) const override;
  bool Minus(const double* y, const double* x, double* y_minus_x) const override;
  bool MinusJacobian(const double* x, double* jacobian) const override;
};

class RelativePoseError final : public ceres::SizedCostFunction<6, kPoseBlockSize, kPoseBlockSize> {
 public:
  RelativePoseError(const Rigid3d& from_tform_to, const Matrix6d& square_root_information)
      : to_tform_from_(from_tform_to.Inverse()),
        square_root_information_(square_root_information) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

  // |r|^2 at the two poses.
  double ChiSquare(const Rigid3d& world_from_i, const Rigid3d& world_from_j) const;

 private:
  Rigid3d to_tform_from_;
  Matrix6d square_root_information_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_RELATIVE_POSE_ERROR_H_
