// SPDX-License-Identifier: Apache-2.0
// Exp(xi) and its right Jacobian together, for what an odometry step is in error.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_SMALL_MOTION_H_
#define OVERTONE_CORE_SYNCHRONIZATION_SMALL_MOTION_H_

#include "Eigen/Core"
#include "overtone/core/geometry/se3.h"
#include "overtone/core/synchronization/twist_matrix.h"

namespace overtone {

struct SmallMotion {
  Eigen::Matrix3d rotation;  // of Exp(xi)
  Eigen::Vector3d translation;
  TwistMatrix right_jacobian;  // Exp(xi + delta) = Exp(xi) Exp(J delta) + O(|delta|^2); J xi = xi

  // Any finite xi; fastest below a fifth of a radian, where the series converge in five terms.
  explicit SmallMotion(const Vector6d& xi);
};

// Exp(xi) * point, without the matrices. Any finite xi.
Eigen::Vector3d MovedBy(const Vector6d& xi, const Eigen::Vector3d& point);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_SMALL_MOTION_H_
