// SPDX-License-Identifier: Apache-2.0
// The residual of one sighted point, for Ceres, with analytic Jacobians:
//
//     r = S * (T^-1 * p - z),   S by square_root_information.h
//
// T = world_from_observer, z the point as measured in the observer's frame, and p in world: a
// landmark, or T_t * q, a point q fixed in the frame of another pose. Poses are blocks moved on the
// right as in relative_pose_error.h, delta = [rho; phi]; with y = T^-1 * p
//
//     dr/d delta   = S * [-I, Skew(y)]
//     dr/d p       = S * R^T                          (landmark: a block of 3 doubles)
//     dr/d delta_t = S * R^T * R_t * [I, -Skew(q)]
#ifndef OVERTONE_CORE_ESTIMATION_POINT_SIGHTING_ERROR_H_
#define OVERTONE_CORE_ESTIMATION_POINT_SIGHTING_ERROR_H_

#include "ceres/sized_cost_function.h"
#include "overtone/core/estimation/relative_pose_error.h"

namespace overtone {

constexpr int kPointBlockSize = 3;

// Blocks: the observer, the landmark.
class LandmarkSightingError final
    : public ceres::SizedCostFunction<3, kPoseBlockSize, kPointBlockSize> {
 public:
  LandmarkSightingError(const Eigen::Vector3d& point_in_pose,
                        const Eigen::Matrix3d& square_root_information)
      : point_in_pose_(point_in_pose), square_root_information_(square_root_information) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector3d point_in_pose_;
  Eigen::Matrix3d square_root_information_;
};

// Blocks: the observer, the pose that carries the point.
class CarriedPointSightingError final
    : public ceres::SizedCostFunction<3, kPoseBlockSize, kPoseBlockSize> {
 public:
  CarriedPointSightingError(const Eigen::Vector3d& point_in_pose,
                            const Eigen::Vector3d& point_in_target,
                            const Eigen::Matrix3d& square_root_information)
      : point_in_pose_(point_in_pose),
        point_in_target_(point_in_target),
        square_root_information_(square_root_information) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override;

 private:
  Eigen::Vector3d point_in_pose_;
  Eigen::Vector3d point_in_target_;
  Eigen::Matrix3d square_root_information_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_POINT_SIGHTING_ERROR_H_
