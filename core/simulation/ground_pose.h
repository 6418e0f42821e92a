// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CORE_SIMULATION_GROUND_POSE_H_
#define OVERTONE_CORE_SIMULATION_GROUND_POSE_H_

#include "Eigen/Core"
#include "overtone/core/geometry/se3.h"

namespace overtone {

// A body on a slope: origin at `position`, x along the horizontal `heading` (not zero), z along the
// normal of ground that rises by `slope` metres for each metre along the world's x and y.
// world_from_body.
Rigid3d PoseOnSlope(const Eigen::Vector3d& position, const Eigen::Vector2d& slope,
                    const Eigen::Vector2d& heading);

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_GROUND_POSE_H_
