// SPDX-License-Identifier: Apache-2.0
// Exp(xi) and its right Jacobian together, for what an odometry step is in error.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_SMALL_MOTION_H_
#define OVERTONE_CORE_SYNCHRONIZATION_SMALL_MOTION_H_

#include <cmath>

#include "Eigen/Core"
#include "Eigen/Geometry"
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

// Exp(xi) * point, without the matrices: with v = rho + phi x point and w = phi x v,
//     point + v + a w + b phi x w,   phi x w = phi (phi . v) - x^2 v,
// a = (1 - cos x) / x^2, b = (x - sin x) / x^3, x = |phi|. Any finite xi; in place, since a search
// asks for millions. Fastest below a fifth of a radian.
inline Eigen::Vector3d MovedBy(const Vector6d& xi, const Eigen::Vector3d& point) {
  constexpr double kSeriesBelow = 0.04;  // the next terms are 1e-15 of the sums
  const Eigen::Vector3d phi = xi.tail<3>();
  const Eigen::Vector3d v = xi.head<3>() + phi.cross(point);
  const double x2 = phi.squaredNorm();
  double a, b;
  if (x2 < kSeriesBelow) {
    a = 1. / 2 - x2 * (1. / 24 - x2 * (1. / 720 - x2 * (1. / 40320 - x2 / 3628800)));
    b = 1. / 6 - x2 * (1. / 120 - x2 * (1. / 5040 - x2 * (1. / 362880 - x2 / 39916800)));
  } else {
    const double x = std::sqrt(x2);
    a = (1 - std::cos(x)) / x2;
    b = (x - std::sin(x)) / (x2 * x);
  }
  return point + (1 - b * x2) * v + a * phi.cross(v) + (b * phi.dot(v)) * phi;
}

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_SMALL_MOTION_H_
