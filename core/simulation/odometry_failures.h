// SPDX-License-Identifier: Apache-2.0
// The failures that a mapping server is there to put right. Bernreiter et al. 2024, "Experiments":
// drift on an open terrace, a corridor that looks the same all along, a jump of the estimate.
#ifndef OVERTONE_CORE_SIMULATION_ODOMETRY_FAILURES_H_
#define OVERTONE_CORE_SIMULATION_ODOMETRY_FAILURES_H_

#include "absl/status/status.h"
#include "overtone/core/geometry/trajectory.h"
#include "overtone/core/simulation/odometry_noise.h"
#include "overtone/core/simulation/random.h"
#include "overtone/core/simulation/scene.h"

namespace overtone {

struct OdometryFailures {
  bool yaw_drift = false;   // on the scene's terrace
  bool degenerate = false;  // in the scene's corridor
  bool jump = false;        // once, in the middle fifth of the run

  double yaw_rate_rps = 2e-3;  // rad/s, to the left; -1..1
  double motion_share = 0.7;   // of the motion along the corridor that is measured; 0..2
  double jump_m = 1.5;         // in a random horizontal direction of the body; 0..100
  double jump_yaw_rad = 0.15;  // to the left; -pi..pi

  // InvalidArgument naming the member.
  absl::Status Validate() const;
};

// Those of `failures` that are on, for odometry of `truth`. Copies what it needs.
MotionFault MakeMotionFault(const OdometryFailures& failures, const Scene& scene,
                            const Trajectory& truth, Random& random);

// Whether the motion of a step that begins at `pose` (world_from_body) is one in the corridor.
bool InCorridor(const Scene& scene, const Rigid3d& pose);

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_ODOMETRY_FAILURES_H_
