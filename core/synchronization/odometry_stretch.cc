// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/odometry_stretch.h"

#include "Eigen/Cholesky"
#include "overtone/core/synchronization/small_motion.h"

namespace overtone {

double OdometryStretch::Condense(const std::vector<OdometryStep>& odometry,
                                 std::vector<StepState>& steps) {
  double cost = 0;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  // begin_from_this
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  CongruenceSum covariance;
  drift.setZero();
  for (int i = begin + 1; i <= end; ++i) {
    const OdometryStep& step = odometry[i];
    const Vector6d& error = steps[i].error;
    const SmallMotion motion(error);
    translation += rotation * step.previous_from_this.translation;
    rotation = rotation * step.previous_from_this.rotation.toRotationMatrix();
    translation += rotation * motion.translation;
    rotation = rotation * motion.rotation;
    const TwistMatrix g = AdjointTimes(rotation, translation, motion.right_jacobian);
    steps[i].begin_from_step = g;
    cost += 0.5 * error.dot(step.information.lazyProduct(error));
    drift -= g * error;
    covariance.Add(g, step.covariance);
  }
  begin_from_end = Rigid3d(Eigen::Quaterniond(rotation).normalized(), translation);
  information = covariance.Sum().llt().solve(Matrix6d::Identity());
  return cost;
}

void OdometryStretch::Spread(const Vector6d& begin_moves, const Vector6d& end_moves,
                             const std::vector<OdometryStep>& odometry,
                             std::vector<StepState>& steps) const {
  const Vector6d lambda = information * (Adjoint(begin_from_end) * end_moves - begin_moves - drift);
  for (int i = begin + 1; i <= end; ++i) {
    StepState& step = steps[i];
    step.change.noalias() =
        odometry[i].covariance.lazyProduct(step.begin_from_step.TransposeTimes(lambda));
    step.change -= step.error;
  }
}

}  // namespace overtone
