// SPDX-License-Identifier: Apache-2.0
// A chain of poses whose motions are independent and uncertain: the relative pose of any two of its
// poses with its covariance, in constant time.
//
// The motion m_j = T_{j-1}^-1 T_j has covariance C_j. To first order (Barfoot & Furgale,
// "Associating Uncertainty With Three-Dimensional Poses", T-RO 30(3), 2014), with S_k = sum_{j <=
// k} Ad(T_j) C_j Ad(T_j)^T, the covariance of T_i^-1 T_k is
//
//     Ad(T_k^-1) (S_k - S_i) Ad(T_k^-1)^T,  i <= k      (S_i - S_k for i > k)
#ifndef OVERTONE_CORE_ESTIMATION_UNCERTAIN_TRAJECTORY_H_
#define OVERTONE_CORE_ESTIMATION_UNCERTAIN_TRAJECTORY_H_

#include "overtone/core/common/block_vector.h"
#include "overtone/core/geometry/packed_covariance.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

class UncertainTrajectory {
 public:
  int Size() const { return static_cast<int>(poses_.size()); }

  // motion_covariance: of the motion from the previous pose, right tangent; that of the first pose
  // counts for nothing.
  void Append(const Rigid3d& world_from_body, const Matrix6d& motion_covariance);

  // Forgets all from pose `size` on, size <= Size().
  void Truncate(int size);

  // i_from_k, in any order.
  Rigid3d WorldFromBody(int i) const { return first_from_world_.Inverse() * poses_[i]; }
  Rigid3d Relative(int i, int k) const { return poses_[i].Inverse() * poses_[k]; }
  // Of Relative(i, k), right tangent; 0 for i = k.
  Matrix6d Covariance(int i, int k) const;

 private:
  Rigid3d first_from_world_;
  BlockVector<Rigid3d> poses_;  // first_from_body: far from the origin the sums would lose digits
  BlockVector<PackedCovariance> sums_;  // S
};

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_UNCERTAIN_TRAJECTORY_H_
