// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/ground_pose.h"

namespace overtone {

Rigid3d PoseOnSlope(const Eigen::Vector3d& position, const Eigen::Vector2d& slope,
                    const Eigen::Vector2d& heading) {
  const Eigen::Vector3d forward =
      Eigen::Vector3d(heading.x(), heading.y(), slope.dot(heading)).normalized();
  const Eigen::Vector3d up = Eigen::Vector3d(-slope.x(), -slope.y(), 1).normalized();
  Eigen::Matrix3d world_from_body;  // orthonormal: `forward` lies in the ground's tangent plane
  world_from_body << forward, up.cross(forward), up;
  return Rigid3d(Eigen::Quaterniond(world_from_body).normalized(), position);
}

}  // namespace overtone
