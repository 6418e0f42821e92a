// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/uncertain_trajectory.h"

namespace overtone {

void UncertainTrajectory::Append(const Rigid3d& world_from_body,
                                 const Matrix6d& motion_covariance) {
  if (poses_.empty()) first_from_world_ = world_from_body.Inverse();
  poses_.push_back(first_from_world_ * world_from_body);
  motion_covariances_.push_back(motion_covariance);
  AppendToSums();
}

void UncertainTrajectory::ReplacePoses(const std::vector<Rigid3d>& world_from_body) {
  std::vector<Matrix6d> motion_covariances;
  motion_covariances.swap(motion_covariances_);
  poses_.clear();
  sums_.clear();
  for (size_t j = 0; j < world_from_body.size(); ++j) {
    Append(world_from_body[j], motion_covariances[j]);
  }
}

Matrix6d UncertainTrajectory::Covariance(int i, int k) const {
  const Matrix6d adjoint = Adjoint(poses_[k].Inverse());
  const Matrix6d between = i <= k ? sums_[k] - sums_[i] : sums_[i] - sums_[k];
  return adjoint * between * adjoint.transpose();
}

void UncertainTrajectory::AppendToSums() {
  if (sums_.empty()) {
    sums_.push_back(Matrix6d::Zero());
    return;
  }
  const Matrix6d adjoint = Adjoint(poses_.back());
  sums_.push_back(sums_.back() + adjoint * motion_covariances_.back() * adjoint.transpose());
}

}  // namespace overtone
