// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/odometry_model.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"

namespace overtone {
namespace {

// A robot that stands still is not known for certain to do so: 0.1 mm, 10 urad.
constexpr double kTranslationFloor_m = 1e-4;
constexpr double kRotationFloor_rad = 1e-5;

}  // namespace

absl::Status OdometryModel::Validate() const {
  for (const auto& [member, value] : {std::pair("translation_per_sqrt_m", translation_per_sqrt_m),
                                      std::pair("rotation_per_sqrt_m", rotation_per_sqrt_m),
                                      std::pair("rotation_per_sqrt_rad", rotation_per_sqrt_rad)}) {
    if (!(value > 0) || !std::isfinite(value)) {
      return absl::InvalidArgumentError(
          absl::StrCat("odometry.", member, ": ", value, " is not finite and positive"));
    }
  }
  return absl::OkStatus();
}

Matrix6d OdometryCovariance(const Rigid3d& previous_from_this, const OdometryModel& model) {
  const double way = previous_from_this.translation.norm();
  const double angle = LogSO3(previous_from_this.rotation).norm();
  Vector6d variance;
  variance.head<3>().setConstant(kTranslationFloor_m * kTranslationFloor_m +
                                 std::pow(model.translation_per_sqrt_m, 2) * way);
  variance.tail<3>().setConstant(kRotationFloor_rad * kRotationFloor_rad +
                                 std::pow(model.rotation_per_sqrt_m, 2) * way +
                                 std::pow(model.rotation_per_sqrt_rad, 2) * angle);
  return variance.asDiagonal();
}

}  // namespace overtone
