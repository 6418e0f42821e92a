// SPDX-License-Identifier: Apache-2.0
// How far a robot's odometry is trusted where its own covariances are not known.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_ODOMETRY_MODEL_H_
#define OVERTONE_CORE_SYNCHRONIZATION_ODOMETRY_MODEL_H_

#include "absl/status/status.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

// A random walk: variances grow in proportion to the way travelled and to the angle turned. Where
// chords are placed depends on the shares of rotation and translation, not on their size.
struct OdometryModel {
  double translation_per_sqrt_m = 0.03;  // standard deviation in metres after 1 m
  double rotation_per_sqrt_m = 0.002;    // rad after 1 m
  double rotation_per_sqrt_rad = 0.01;   // rad after turning 1 rad

  absl::Status Validate() const;  // InvalidArgument naming the member
};

// Right-tangent covariance of one motion; positive definite even when the robot stands.
Matrix6d OdometryCovariance(const Rigid3d& previous_from_this, const OdometryModel& model);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_ODOMETRY_MODEL_H_
