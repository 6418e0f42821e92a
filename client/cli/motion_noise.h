// SPDX-License-Identifier: Apache-2.0
// How far odometry is trusted, where its source does not say.
#ifndef OVERTONE_CLIENT_CLI_MOTION_NOISE_H_
#define OVERTONE_CLIENT_CLI_MOTION_NOISE_H_

#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

// A random walk: variances grow in proportion to the way travelled and to the angle turned.
struct MotionNoise {
  double translation_per_sqrt_m = 0.02;  // m of standard deviation after 1 m
  double rotation_per_sqrt_m = 0.002;    // rad after 1 m
  double rotation_per_sqrt_rad = 0.01;   // rad after turning 1 rad

  absl::Status Validate() const;  // finite, > 0
};

// "translation=0.02,rotation=0.002,turn=0.01", any subset, over `defaults`.
absl::StatusOr<MotionNoise> ParseMotionNoise(absl::string_view text, const MotionNoise& defaults);

// Covariance (right tangent) of one motion a_from_b.
Matrix6d MotionCovariance(const Rigid3d& motion, const MotionNoise& noise);

// Covariance of a_from_b * b_from_c, both uncertain and independent: the first is carried through
// the second.
Matrix6d CompoundCovariance(const Matrix6d& covariance_ab, const Rigid3d& b_from_c,
                            const Matrix6d& covariance_bc);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_MOTION_NOISE_H_
