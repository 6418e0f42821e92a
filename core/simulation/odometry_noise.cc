// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/odometry_noise.h"

#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/simulation/random.h"

namespace overtone {

absl::Status OdometryNoise::Validate() const {
  const std::pair<const char*, double> members[] = {
      {"translation_density", translation_density},
      {"rotation_density", rotation_density},
      {"initial_yaw_bias_sigma", initial_yaw_bias_sigma},
      {"yaw_bias_walk_density", yaw_bias_walk_density},
      {"scale_sigma", scale_sigma}};
  for (const auto& [name, value] : members) {
    if (!(value >= 0 && std::isfinite(value))) {
      return absl::InvalidArgumentError(
          absl::StrCat("OdometryNoise.", name, ": must be finite and not negative, is ", value));
    }
  }
  return absl::OkStatus();
}

Trajectory SimulateOdometry(const Trajectory& truth, const OdometryNoise& noise, uint64_t seed,
                            const MotionFault& fault) {
  Random random(seed);
  const double scale = 1 + noise.scale_sigma * random.Normal();
  double yaw_bias = noise.initial_yaw_bias_sigma * random.Normal();
  Trajectory odometry;
  odometry.reserve(truth.size());
  if (!truth.empty()) odometry.push_back({truth.front().stamp, Rigid3d()});
  for (size_t i = 1; i < truth.size(); ++i) {
    const double dt = SecondsBetween(truth[i - 1].stamp, truth[i].stamp);
    Rigid3d previous_from_this = truth[i - 1].pose.Inverse() * truth[i].pose;
    if (fault) previous_from_this = fault(static_cast<int>(i), previous_from_this);
    previous_from_this.translation *= scale;
    Vector6d error;
    error.head<3>() = noise.translation_density * std::sqrt(dt) * random.Normal3();
    error.tail<3>() = noise.rotation_density * std::sqrt(dt) * random.Normal3();
    error[5] += yaw_bias * dt;
    yaw_bias += noise.yaw_bias_walk_density * std::sqrt(dt) * random.Normal();
    odometry.push_back({truth[i].stamp, odometry.back().pose * (previous_from_this * Exp(error))});
  }
  return odometry;
}

}  // namespace overtone
