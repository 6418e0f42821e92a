// SPDX-License-Identifier: Apache-2.0
// Dead reckoning in the plane.
#ifndef OVERTONE_CLIENT_CLI_VELOCITY_ODOMETRY_H_
#define OVERTONE_CLIENT_CLI_VELOCITY_ODOMETRY_H_

#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/geometry/trajectory.h"

namespace overtone {

// Body axes: x ahead, y left, turning about z. Holds from its stamp to the next one's.
struct PlanarVelocity {
  Timestamp stamp;
  double ahead_m_per_s = 0;
  double left_m_per_s = 0;
  double turn_rad_per_s = 0;
};

// Appends `velocity`; of two with one stamp the later one counts. InvalidArgument: time runs back.
absl::Status AppendVelocity(const PlanarVelocity& velocity,
                            std::vector<PlanarVelocity>* velocities);

// mission_from_body at every velocity's stamp and at each of `also` that lies between the first and
// the last, exactly along the arcs, from the identity on. `also` is sorted. InvalidArgument: the
// robot leaves the world (parse_pose.h).
absl::StatusOr<Trajectory> IntegrateVelocities(const std::vector<PlanarVelocity>& velocities,
                                               const std::vector<Timestamp>& also);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_VELOCITY_ODOMETRY_H_
