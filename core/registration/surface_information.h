// SPDX-License-Identifier: Apache-2.0
// What a pair of points on surfaces says about their distance.
#ifndef OVERTONE_CORE_REGISTRATION_SURFACE_INFORMATION_H_
#define OVERTONE_CORE_REGISTRATION_SURFACE_INFORMATION_H_

#include "Eigen/Core"

namespace overtone {

// Variance along the normal over the variance within the surface: Segal et al. use 1e-3.
inline constexpr double kSurfaceEpsilon = 1e-3;

// Generalized-ICP's information of a pair, (C(n) + C(m))^-1 with C(n) = I - (1 - eps) n n^T, times
// 2 eps so that surfaces with a common normal weigh 1 along it (and eps within). Unit normals of
// either sign, in one frame; symmetric positive definite.
//
// C(n) + C(m) = 2 I - (1 - eps)(n n^T + m m^T) has the eigenvectors n + m and n - m, which gives
// the inverse without a division that could fail.
inline Eigen::Matrix3d SurfaceInformation(const Eigen::Vector3d& n, const Eigen::Vector3d& m) {
  constexpr double a = 1 - kSurfaceEpsilon;
  const double cosine = n.dot(m);
  const Eigen::Vector3d sum = n + m, difference = n - m;
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity() * kSurfaceEpsilon;
  information.noalias() +=
      (kSurfaceEpsilon * a / 2 / (2 - a * (1 + cosine))) * sum * sum.transpose();
  information.noalias() +=
      (kSurfaceEpsilon * a / 2 / (2 - a * (1 - cosine))) * difference * difference.transpose();
  return information;
}

}  // namespace overtone

#endif  // OVERTONE_CORE_REGISTRATION_SURFACE_INFORMATION_H_
