// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/uncertain_trajectory.h"

#include <algorithm>

namespace overtone {

void UncertainTrajectory::Append(const Rigid3d& world_from_body,
                                 const Matrix6d& motion_covariance) {
  if (poses_.empty()) {
    first_from_world_ = world_from_body.Inverse();
    poses_.push_back(first_from_world_ * world_from_body);
    sums_.push_back(PackedCovariance(Matrix6d::Zero()));
    return;
  }
  poses_.push_back(first_from_world_ * world_from_body);
  const Matrix6d adjoint = Adjoint(poses_.back());
  sums_.push_back(PackedCovariance(sums_.back().Unpacked() +
                                   adjoint * motion_covariance * adjoint.transpose()));
}

void UncertainTrajectory::Truncate(int size) {
  poses_.truncate(size);
  sums_.truncate(size);
}

Matrix6d UncertainTrajectory::Covariance(int i, int k) const {
  const Matrix6d adjoint = Adjoint(poses_[k].Inverse());
  const Matrix6d between = sums_[std::max(i, k)].Unpacked() - sums_[std::min(i, k)].Unpacked();
  return adjoint * between * adjoint.transpose();
}

}  // namespace overtone
