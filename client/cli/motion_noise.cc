// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/motion_noise.h"

#include <cmath>

#include "overtone/client/cli/key_values.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

// A robot that stands still is not known for certain to do so: 0.1 mm, 10 urad.
constexpr double kTranslationFloor = 1e-4;
constexpr double kRotationFloor = 1e-5;

bool Positive(double value) { return std::isfinite(value) && value > 0; }

}  // namespace

absl::Status MotionNoise::Validate() const {
  if (!Positive(translation_per_sqrt_m) || !Positive(rotation_per_sqrt_m) ||
      !Positive(rotation_per_sqrt_rad)) {
    return absl::InvalidArgumentError("translation, rotation and turn must be positive");
  }
  return absl::OkStatus();
}

absl::StatusOr<MotionNoise> ParseMotionNoise(absl::string_view text, const MotionNoise& defaults) {
  MotionNoise noise = defaults;
  RETURN_IF_ERROR(ParseKeyValues(text, {{"translation", &noise.translation_per_sqrt_m},
                                        {"rotation", &noise.rotation_per_sqrt_m},
                                        {"turn", &noise.rotation_per_sqrt_rad}}));
  RETURN_IF_ERROR(noise.Validate());
  return noise;
}

Matrix6d MotionCovariance(const Rigid3d& motion, const MotionNoise& noise) {
  const double distance = motion.translation.norm();
  const double angle = LogSO3(motion.rotation).norm();
  const double translation_variance =
      kTranslationFloor * kTranslationFloor + std::pow(noise.translation_per_sqrt_m, 2) * distance;
  const double rotation_variance = kRotationFloor * kRotationFloor +
                                   std::pow(noise.rotation_per_sqrt_m, 2) * distance +
                                   std::pow(noise.rotation_per_sqrt_rad, 2) * angle;
  Matrix6d covariance = Matrix6d::Zero();
  covariance.diagonal().head<3>().setConstant(translation_variance);
  covariance.diagonal().tail<3>().setConstant(rotation_variance);
  return covariance;
}

// (A Exp(a)) (B Exp(b)) = A B Exp(Adj(B^-1) a) Exp(b).
Matrix6d CompoundCovariance(const Matrix6d& covariance_ab, const Rigid3d& b_from_c,
                            const Matrix6d& covariance_bc) {
  const Matrix6d adjoint = Adjoint(b_from_c.Inverse());
  const Matrix6d sum = adjoint * covariance_ab * adjoint.transpose() + covariance_bc;
  return 0.5 * (sum + sum.transpose());
}

}  // namespace overtone
