// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/velocity_odometry.h"

#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/parse_pose.h"

namespace overtone {
namespace {

Rigid3d Drive(const Rigid3d& pose, const PlanarVelocity& velocity, Timestamp until) {
  Vector6d twist = Vector6d::Zero();
  twist[0] = velocity.ahead_m_per_s;
  twist[1] = velocity.left_m_per_s;
  twist[5] = velocity.turn_rad_per_s;
  return pose * Exp(twist * SecondsBetween(velocity.stamp, until));
}

}  // namespace

absl::Status AppendVelocity(const PlanarVelocity& velocity,
                            std::vector<PlanarVelocity>* velocities) {
  if (!velocities->empty()) {
    if (velocity.stamp < velocities->back().stamp) {
      return absl::InvalidArgumentError("the time runs back");
    }
    if (velocity.stamp == velocities->back().stamp) velocities->pop_back();
  }
  velocities->push_back(velocity);
  return absl::OkStatus();
}

absl::StatusOr<Trajectory> IntegrateVelocities(const std::vector<PlanarVelocity>& velocities,
                                               const std::vector<Timestamp>& also) {
  Trajectory trajectory;
  Rigid3d pose;
  auto extra = also.begin();
  for (size_t i = 0; i < velocities.size(); ++i) {
    if (i > 0) pose = Drive(pose, velocities[i - 1], velocities[i].stamp);
    RETURN_IF_ERROR(CheckedPose(pose.translation, pose.rotation.coeffs()).status());
    trajectory.push_back({velocities[i].stamp, pose});
    if (i + 1 == velocities.size()) break;
    for (; extra != also.end() && *extra < velocities[i + 1].stamp; ++extra) {
      if (*extra <= trajectory.back().stamp) continue;
      trajectory.push_back({*extra, Drive(pose, velocities[i], *extra)});
    }
  }
  return trajectory;
}

}  // namespace overtone
