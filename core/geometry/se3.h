// SPDX-License-Identifier: Apache-2.0
// Rigid motions in 3-D, their logarithm and its Jacobians. The conventions of the whole project are
// said here:
//
//   * `a_from_b` (on the wire: `a_tform_b`) takes a point given in frame b to frame a: p_a =
//   a_from_b * p_b.
//   * Quaternions are Hamilton, written and stored x y z w, unit length.
//   * Tangents put translation first: xi = [rho; phi], metres and radians; T = Exp(xi), xi =
//   Log(T),
//     Xi = wedge(xi) = [[phi^x, rho], [0, 0]].
//   * Perturbations and covariances are on the right: T = T_mean * Exp(delta), Cov = E[delta
//   delta^T].
#ifndef OVERTONE_CORE_GEOMETRY_SE3_H_
#define OVERTONE_CORE_GEOMETRY_SE3_H_

#include "Eigen/Core"
#include "Eigen/Geometry"

namespace overtone {

using Vector6d = Eigen::Matrix<double, 6, 1>;
using Matrix6d = Eigen::Matrix<double, 6, 6>;

// A rigid motion. The rotation is a unit quaternion up to round-off; who fills it from input
// normalises it.
struct Rigid3d {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();

  Rigid3d() = default;
  Rigid3d(const Eigen::Quaterniond& rotation, const Eigen::Vector3d& translation)
      : rotation(rotation), translation(translation) {}

  static Rigid3d Identity() { return Rigid3d(); }

  Rigid3d Inverse() const {
    const Eigen::Quaterniond inverse = rotation.conjugate();
    return Rigid3d(inverse, -(inverse * translation));
  }
  // 4 x 4 homogeneous matrix.
  Eigen::Matrix4d ToMatrix() const;
};

// a_from_c = a_from_b * b_from_c. Keeps the quaternion at unit length over millions of products.
Rigid3d operator*(const Rigid3d& a_from_b, const Rigid3d& b_from_c);
inline Eigen::Vector3d operator*(const Rigid3d& a_from_b, const Eigen::Vector3d& point_in_b) {
  return a_from_b.rotation * point_in_b + a_from_b.translation;
}

// Skew-symmetric matrix: Skew(v) * w = v x w.
Eigen::Matrix3d Skew(const Eigen::Vector3d& v);

// Rotation vector <-> unit quaternion. Log takes the shortest way (|phi| <= pi) by atan2, accurate
// from 0 to pi.
Eigen::Quaterniond ExpSO3(const Eigen::Vector3d& phi);
Eigen::Vector3d LogSO3(const Eigen::Quaterniond& rotation);

// xi = [rho; phi] <-> rigid motion. Barfoot, State Estimation for Robotics, 7.1.3.
Rigid3d Exp(const Vector6d& xi);
Vector6d Log(const Rigid3d& transform);

// T * Exp(xi) * T^-1 = Exp(Adjoint(T) * xi).
Matrix6d Adjoint(const Rigid3d& transform);

// Log(Exp(xi) * Exp(delta)) = xi + InverseRightJacobian(xi) * delta + O(|delta|^2); the left one
// for Log(Exp(delta) * Exp(xi)). |phi| < 2 pi. Barfoot, 7.83 and 7.86.
Matrix6d InverseRightJacobian(const Vector6d& xi);
Matrix6d InverseLeftJacobian(const Vector6d& xi);

}  // namespace overtone

#endif  // OVERTONE_CORE_GEOMETRY_SE3_H_
