// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/odometry_failures.h"

#include <cmath>

#include "overtone/core/common/status_macros.h"
#include "overtone/core/simulation/option_range.h"

namespace overtone {
namespace {

bool Contains(const std::optional<Eigen::AlignedBox2d>& box, const Rigid3d& pose) {
  const Eigen::Vector2d position = pose.translation.head<2>();
  return box.has_value() && box->contains(position);
}

Rigid3d Turn(double yaw, const Eigen::Vector3d& translation) {
  return Rigid3d(ExpSO3({0, 0, yaw}), translation);
}

}  // namespace

absl::Status OdometryFailures::Validate() const {
  const OptionRange range("OdometryFailures");
  RETURN_IF_ERROR(range.Check("yaw_rate_rps", yaw_rate_rps, -1, 1));
  RETURN_IF_ERROR(range.Check("motion_share", motion_share, 0, 2));
  RETURN_IF_ERROR(range.Check("jump_m", jump_m, 0, 100));
  return range.Check("jump_yaw_rad", jump_yaw_rad, -M_PI, M_PI);
}

bool InCorridor(const Scene& scene, const Rigid3d& pose) { return Contains(scene.corridor, pose); }

MotionFault MakeMotionFault(const OdometryFailures& failures, const Scene& scene,
                            const Trajectory& truth, Random& random) {
  const double when = 0.4 + 0.2 * random.Uniform(), where = 2 * M_PI * random.Uniform();
  const int jump_step = 1 + static_cast<int>(when * static_cast<double>(truth.size()));
  const Rigid3d jump = Turn(failures.jump_yaw_rad,
                            failures.jump_m * Eigen::Vector3d(std::cos(where), std::sin(where), 0));
  return [=](int step, const Rigid3d& true_motion) {
    const StampedPose& previous = truth[step - 1];
    Rigid3d motion = true_motion;
    if (failures.degenerate && InCorridor(scene, previous.pose)) {
      const Eigen::Vector3d axis = previous.pose.rotation.conjugate() * Eigen::Vector3d::UnitX();
      motion.translation -= (1 - failures.motion_share) * axis.dot(motion.translation) * axis;
    }
    if (failures.yaw_drift && Contains(scene.terrace, previous.pose)) {
      const double dt = SecondsBetween(previous.stamp, truth[step].stamp);
      motion = motion * Turn(failures.yaw_rate_rps * dt, Eigen::Vector3d::Zero());
    }
    if (failures.jump && step == jump_step) motion = motion * jump;
    return motion;
  };
}

}  // namespace overtone
