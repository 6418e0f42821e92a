// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/small_motion.h"

#include <cmath>

namespace overtone {
namespace {

// The functions of x^2 that Exp and its Jacobian are made of.
struct Coefficients {
  double a;  // (1 - cos x) / x^2
  double b;  // (x - sin x) / x^3
  double c;  // (x^2 + 2 cos x - 2) / (2 x^4)
  double d;  // (2 x - 3 sin x + x cos x) / (2 x^5)
};

Coefficients CoefficientsOf(double x2) {
  constexpr double kSeriesBelow = 0.04;  // the next terms are 1e-15 of the sums
  if (x2 < kSeriesBelow) {
    return {
        1. / 2 - x2 * (1. / 24 - x2 * (1. / 720 - x2 * (1. / 40320 - x2 / 3628800))),
        1. / 6 - x2 * (1. / 120 - x2 * (1. / 5040 - x2 * (1. / 362880 - x2 / 39916800))),
        1. / 24 - x2 * (1. / 720 - x2 * (1. / 40320 - x2 * (1. / 3628800 - x2 / 479001600))),
        1. / 120 - x2 * (1. / 2520 - x2 * (1. / 120960 - x2 * (1. / 9979200 - x2 / 1245404160)))};
  }
  const double x = std::sqrt(x2), sine = std::sin(x), cosine = std::cos(x);
  return {(1 - cosine) / x2, (x - sine) / (x2 * x), (x2 + 2 * cosine - 2) / (2 * x2 * x2),
          (2 * x - 3 * sine + x * cosine) / (2 * x2 * x2 * x)};
}

}  // namespace

// With P = phi^x and R = rho^x:
//     Exp SO(3) = I + (1 - b x^2) P + a P^2,     J_r SO(3) = I - a P + b P^2,
// and the coupling block is that of Barfoot, 7.86b, at -xi, where P R P = -(phi . rho) P and P^2 R
// + R P^2 = -(phi . rho) P - x^2 R spare the products.
SmallMotion::SmallMotion(const Vector6d& xi) {
  const Eigen::Vector3d rho = xi.head<3>(), phi = xi.tail<3>();
  const double x2 = phi.squaredNorm(), dot = phi.dot(rho);
  const Coefficients f = CoefficientsOf(x2);
  const Eigen::Matrix3d p = Skew(phi);
  Eigen::Matrix3d pp = phi * phi.transpose();
  pp.diagonal().array() -= x2;
  rotation = (1 - f.b * x2) * p + f.a * pp;
  rotation.diagonal().array() += 1;
  right_jacobian.x = -f.a * p + f.b * pp;
  right_jacobian.x.diagonal().array() += 1;
  translation.noalias() = right_jacobian.x.transpose() * rho;  // J_l(phi) = J_r(phi)^T
  const Eigen::Matrix3d rho_phi = rho * phi.transpose();
  right_jacobian.y = -f.a * Skew(rho) + (f.b - 2 * f.c) * dot * p +
                     f.b * (rho_phi + rho_phi.transpose()) - 2 * f.d * dot * pp;
  right_jacobian.y.diagonal().array() -= 2 * f.b * dot;
}

}  // namespace overtone
