// SPDX-License-Identifier: Apache-2.0
// From the true motion to what an odometry would have said of it.
#ifndef OVERTONE_CORE_SIMULATION_ODOMETRY_NOISE_H_
#define OVERTONE_CORE_SIMULATION_ODOMETRY_NOISE_H_

#include <cstdint>
#include <functional>

#include "absl/status/status.h"
#include "overtone/core/geometry/trajectory.h"

namespace overtone {

// A visual-inertial or wheel odometry: gravity holds roll and pitch, so only yaw has a bias.
struct OdometryNoise {
  double translation_density = 0.01;     // white, m / sqrt(s), each axis of the body
  double rotation_density = 3e-4;        // white, rad / sqrt(s), each axis of the body
  double initial_yaw_bias_sigma = 6e-4;  // rad/s, drawn once
  double yaw_bias_walk_density = 6e-5;   // random walk of the yaw bias, rad / s / sqrt(s)
  double scale_sigma = 0.015;            // relative error of all lengths, drawn once

  absl::Status Validate() const;  // all finite and >= 0
};

// What goes wrong beside noise: the motion of a step, from pose step - 1 to pose step >= 1, as the
// sensors let it appear.
using MotionFault = std::function<Rigid3d(int step, const Rigid3d& previous_from_this)>;

// The motion of each step, first with its fault if there is one, then scaled and disturbed on the
// right: prev_from_next * Exp(noise), composed from the identity. Same stamps as `truth`; empty
// when that is. Valid `noise` expected. One seed, one result; a fault does not shift the noise.
Trajectory SimulateOdometry(const Trajectory& truth, const OdometryNoise& noise, uint64_t seed,
                            const MotionFault& fault = nullptr);

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_ODOMETRY_NOISE_H_
