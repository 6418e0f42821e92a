// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/drift_injection.h"

#include <cmath>

#include "absl/strings/str_format.h"
#include "overtone/client/cli/key_values.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/simulation/random.h"

namespace overtone {
namespace {

bool InRange(double value) { return value >= 0 && value <= 10; }

}  // namespace

absl::StatusOr<DriftInjection> ParseDriftInjection(absl::string_view text) {
  DriftInjection drift;
  RETURN_IF_ERROR(ParseKeyValues(text, {{"translation", &drift.translation_per_sqrt_m},
                                        {"rotation", &drift.rotation_per_sqrt_m},
                                        {"seed", &drift.seed}}));
  if (!InRange(drift.translation_per_sqrt_m) || !InRange(drift.rotation_per_sqrt_m) ||
      drift.translation_per_sqrt_m + drift.rotation_per_sqrt_m == 0) {
    return absl::InvalidArgumentError("translation and rotation must be in [0, 10], not both 0");
  }
  if (!(drift.seed >= 0 && drift.seed < 9e15)) {
    return absl::InvalidArgumentError("seed must be in [0, 9e15)");
  }
  return drift;
}

std::string Describe(const DriftInjection& drift) {
  return absl::StrFormat(
      "Drift was INJECTED into the recorded odometry, which is taken for the ground truth where "
      "there is no other: a random walk of %g m and %g rad per axis after 1 m, seed %.0f.",
      drift.translation_per_sqrt_m, drift.rotation_per_sqrt_m, drift.seed);
}

void InjectDrift(const DriftInjection& drift, uint64_t stream, Recording* recording) {
  Random seeds(static_cast<uint64_t>(drift.seed));
  uint64_t seed = seeds.Fork();
  for (uint64_t i = 0; i < stream; ++i) seed = seeds.Fork();
  Random random(seed);
  Trajectory& odometry = recording->odometry;
  Rigid3d original = odometry.empty() ? Rigid3d() : odometry[0].pose;
  for (size_t i = 1; i < odometry.size(); ++i) {
    const Rigid3d step = original.Inverse() * odometry[i].pose;
    original = odometry[i].pose;
    const double root_m = std::sqrt(step.translation.norm());
    Vector6d noise;
    noise << random.Normal3() * (drift.translation_per_sqrt_m * root_m),
        random.Normal3() * (drift.rotation_per_sqrt_m * root_m);
    odometry[i].pose = odometry[i - 1].pose * step * Exp(noise);
    if (recording->motion_covariances.empty()) continue;
    Matrix6d& covariance = recording->motion_covariances[i];
    covariance.diagonal().head<3>().array() += std::pow(drift.translation_per_sqrt_m * root_m, 2);
    covariance.diagonal().tail<3>().array() += std::pow(drift.rotation_per_sqrt_m * root_m, 2);
  }
}

MotionNoise WithDrift(MotionNoise noise, const DriftInjection& drift) {
  noise.translation_per_sqrt_m =
      std::hypot(noise.translation_per_sqrt_m, drift.translation_per_sqrt_m);
  noise.rotation_per_sqrt_m = std::hypot(noise.rotation_per_sqrt_m, drift.rotation_per_sqrt_m);
  return noise;
}

}  // namespace overtone
