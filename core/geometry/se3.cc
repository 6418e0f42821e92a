// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/geometry/se3.h"

#include <cmath>

namespace overtone {
namespace {

// sin(x)/x, (1 - cos x)/x^2 and their kin, by Taylor series where the closed forms cancel.
struct TrigonometricSeries {
  double sin_over;          // sin(x) / x
  double one_minus_cos;     // (1 - cos x) / x^2
  double x_minus_sin;       // (x - sin x) / x^3
  double x2_plus_2cos;      // (x^2 + 2 cos x - 2) / (2 x^4)
  double two_x_minus_3sin;  // (2x - 3 sin x + x cos x) / (2 x^5)
};

TrigonometricSeries Series(double x) {
  const double x2 = x * x;
  if (x < 0.5) {
    TrigonometricSeries sum{1, 0.5, 1.0 / 6, 1.0 / 24, 1.0 / 120};
    double term = 1;  // (-1)^k x^2k / (2k+1)!
    for (int k = 1; k <= 7; ++k) {
      term *= -x2 / ((2 * k) * (2 * k + 1));
      const double over_4 = term / ((2 * k + 2) * (2 * k + 3) * (2 * k + 4));
      sum.sin_over += term;
      sum.one_minus_cos += term / (2 * k + 2);
      sum.x_minus_sin += term / ((2 * k + 2) * (2 * k + 3));
      sum.x2_plus_2cos += over_4;
      sum.two_x_minus_3sin += (k + 1) * over_4 / (2 * k + 5);
    }
    return sum;
  }
  const double s = std::sin(x), c = std::cos(x);
  return {s / x, (1 - c) / x2, (x - s) / (x2 * x), (x2 + 2 * c - 2) / (2 * x2 * x2),
          (2 * x - 3 * s + x * c) / (2 * x2 * x2 * x)};
}

// The translation of Exp([rho; phi]) is LeftJacobianSO3(phi) * rho.
Eigen::Matrix3d LeftJacobianSO3(const Eigen::Vector3d& phi) {
  const TrigonometricSeries f = Series(phi.norm());
  const Eigen::Matrix3d k = Skew(phi);
  return Eigen::Matrix3d::Identity() + f.one_minus_cos * k + f.x_minus_sin * k * k;
}

Eigen::Matrix3d InverseLeftJacobianSO3(const Eigen::Vector3d& phi) {
  // 1/x^2 - (1 + cos x) / (2 x sin x), by the half angle: finite at 0 and at pi.
  const TrigonometricSeries half = Series(0.5 * phi.norm());
  const double c = (half.one_minus_cos - half.x_minus_sin) / (4 * half.sin_over);
  const Eigen::Matrix3d k = Skew(phi);
  return Eigen::Matrix3d::Identity() - 0.5 * k + c * k * k;
}

// The coupling block Q of the SE(3) left Jacobian. Barfoot, 7.86b.
Eigen::Matrix3d CouplingBlock(const Eigen::Vector3d& rho, const Eigen::Vector3d& phi) {
  const TrigonometricSeries f = Series(phi.norm());
  const Eigen::Matrix3d r = Skew(rho), p = Skew(phi);
  const Eigen::Matrix3d pr = p * r, rp = r * p, prp = pr * p, pp = p * p;
  return 0.5 * r + f.x_minus_sin * (pr + rp + prp) + f.x2_plus_2cos * (pp * r + r * pp - 3 * prp) +
         f.two_x_minus_3sin * (prp * p + p * prp);
}

}  // namespace

Eigen::Matrix4d Rigid3d::ToMatrix() const {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  matrix.topLeftCorner<3, 3>() = rotation.toRotationMatrix();
  matrix.topRightCorner<3, 1>() = translation;
  return matrix;
}

Rigid3d operator*(const Rigid3d& a_from_b, const Rigid3d& b_from_c) {
  Eigen::Quaterniond rotation = a_from_b.rotation * b_from_c.rotation;
  // One Newton step towards unit length: exact to second order, no square root.
  rotation.coeffs() *= 0.5 * (3 - rotation.squaredNorm());
  return Rigid3d(rotation, a_from_b * b_from_c.translation);
}

Eigen::Matrix3d Skew(const Eigen::Vector3d& v) {
  Eigen::Matrix3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Eigen::Quaterniond ExpSO3(const Eigen::Vector3d& phi) {
  const double half = 0.5 * phi.norm();
  const Eigen::Vector3d imaginary = 0.5 * Series(half).sin_over * phi;
  return Eigen::Quaterniond(std::cos(half), imaginary.x(), imaginary.y(), imaginary.z());
}

Eigen::Vector3d LogSO3(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0 ? -1.0 : 1.0;
  const double w = sign * rotation.w();
  const Eigen::Vector3d imaginary = sign * rotation.vec();
  const double norm = imaginary.norm();
  // atan2(n, w) / n -> 1 / w as n -> 0.
  const double factor = norm < 1e-9 ? 2.0 / w : 2.0 * std::atan2(norm, w) / norm;
  return factor * imaginary;
}

Rigid3d Exp(const Vector6d& xi) {
  const Eigen::Vector3d phi = xi.tail<3>();
  return Rigid3d(ExpSO3(phi), LeftJacobianSO3(phi) * xi.head<3>());
}

Vector6d Log(const Rigid3d& transform) {
  const Eigen::Vector3d phi = LogSO3(transform.rotation);
  Vector6d xi;
  xi << InverseLeftJacobianSO3(phi) * transform.translation, phi;
  return xi;
}

Matrix6d Adjoint(const Rigid3d& transform) {
  const Eigen::Matrix3d rotation = transform.rotation.toRotationMatrix();
  Matrix6d adjoint = Matrix6d::Zero();
  adjoint.topLeftCorner<3, 3>() = rotation;
  adjoint.topRightCorner<3, 3>() = Skew(transform.translation) * rotation;
  adjoint.bottomRightCorner<3, 3>() = rotation;
  return adjoint;
}

Matrix6d InverseLeftJacobian(const Vector6d& xi) {
  const Eigen::Vector3d phi = xi.tail<3>();
  const Eigen::Matrix3d rotation_block = InverseLeftJacobianSO3(phi);
  Matrix6d inverse = Matrix6d::Zero();
  inverse.topLeftCorner<3, 3>() = rotation_block;
  inverse.topRightCorner<3, 3>() =
      -rotation_block * CouplingBlock(xi.head<3>(), phi) * rotation_block;
  inverse.bottomRightCorner<3, 3>() = rotation_block;
  return inverse;
}

Matrix6d InverseRightJacobian(const Vector6d& xi) { return InverseLeftJacobian(-xi); }

}  // namespace overtone
