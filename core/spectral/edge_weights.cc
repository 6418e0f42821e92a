// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/edge_weights.h"

#include <algorithm>
#include <cmath>

#include "absl/strings/str_cat.h"

namespace overtone {
namespace {

// phi and |rho|^2 of Log(a^-1 b) = [rho; phi].
struct LogLengths {
  Eigen::Vector3d phi;
  double squared_rho;
};

// rho = V(phi)^-1 t. V keeps the part of t along the axis and, across it, turns t and scales it by
// sin(angle / 2) / (angle / 2). Barfoot, State Estimation for Robotics, 7.1.3.
LogLengths RelativeLog(const Rigid3d& a, const Rigid3d& b) {
  const Eigen::Quaterniond a_from_b = a.rotation.conjugate() * b.rotation;
  const double sine = a_from_b.vec().norm();
  const double half_angle = std::atan2(sine, std::abs(a_from_b.w()));
  const Eigen::Vector3d offset = b.translation - a.translation;
  const double squared_offset = offset.squaredNorm();
  if (sine < 1e-9) return {2 * std::copysign(1.0, a_from_b.w()) * a_from_b.vec(), squared_offset};
  const double along = (a.rotation * a_from_b.vec()).dot(offset) / sine;
  const double squared_across = std::max(0.0, squared_offset - along * along);
  const double stretch = half_angle * a_from_b.norm() / sine;  // angle / 2 over its sine
  return {std::copysign(2 * half_angle / sine, a_from_b.w()) * a_from_b.vec(),
          along * along + stretch * stretch * squared_across};
}

// tr(Xi M Xi^T) is the sum over Xi's columns of weight times squared length.
double Se3Distance(const Rigid3d& a, const Rigid3d& b, const Eigen::Vector4d& m) {
  const LogLengths log = RelativeLog(a, b);
  const Eigen::Vector3d phi2 = log.phi.cwiseAbs2();
  return std::sqrt(m[0] * (phi2.y() + phi2.z()) + m[1] * (phi2.x() + phi2.z()) +
                   m[2] * (phi2.x() + phi2.y()) + m[3] * log.squared_rho);
}

}  // namespace

MetricWeights PrototypeSignalWeights() { return {Eigen::Vector4d(10, 10, 0.001, 0.001)}; }

absl::Status RadiusGraphOptions::Validate() const {
  if (!(radius_m > 0) || !(radius_m < 1e150)) {
    return absl::InvalidArgumentError(
        absl::StrCat("radius_m: ", radius_m, " is not positive and finite"));
  }
  if (!(sigma > 0) || !std::isfinite(sigma)) {
    return absl::InvalidArgumentError(
        absl::StrCat("sigma: ", sigma, " is not positive and finite"));
  }
  if (!weights.diagonal.allFinite() || !(weights.diagonal.minCoeff() >= 0)) {
    return absl::InvalidArgumentError("weights.diagonal: not finite and non-negative");
  }
  return absl::OkStatus();
}

double PoseDistance(const Rigid3d& a, const Rigid3d& b, DistanceMetric metric,
                    const MetricWeights& weights) {
  switch (metric) {
    case DistanceMetric::kSe3:
      return Se3Distance(a, b, weights.diagonal);
    case DistanceMetric::kR3:
      return (b.translation - a.translation).norm();
    case DistanceMetric::kSo3: {
      const Eigen::Quaterniond a_from_b = a.rotation.conjugate() * b.rotation;
      return 2 * std::atan2(a_from_b.vec().norm(), std::abs(a_from_b.w()));
    }
    case DistanceMetric::kSo3Trace:
      return 3 - 4 * (a.rotation.conjugate() * b.rotation).vec().squaredNorm();
  }
  return 0;
}

}  // namespace overtone
