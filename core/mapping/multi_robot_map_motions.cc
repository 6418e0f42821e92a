// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>

#include "Eigen/Cholesky"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/estimation/square_root_information.h"
#include "overtone/core/mapping/multi_robot_map_state.h"

namespace overtone {

// The odometry's own, and where the robot flags the motion degenerate as much more as it may be
// wrong: along the direction it names, or in all.
Matrix6d MultiRobotMap::State::MotionCovariance(const Keyframe* previous,
                                                const Keyframe& keyframe) const {
  Matrix6d covariance = keyframe.motion_covariance;
  if (!keyframe.degenerate || previous == nullptr) return covariance;
  const double length =
      (keyframe.mission_from_body.translation - previous->mission_from_body.translation).norm();
  const double variance = std::pow(options.degenerate_motion_share * length, 2);
  const Eigen::Vector3d& direction = keyframe.degenerate_direction;
  if (direction.isZero()) {
    covariance.topLeftCorner<3, 3>().diagonal().array() += variance;
  } else {
    covariance.topLeftCorner<3, 3>() += variance * direction * direction.transpose();
  }
  return covariance;
}

// Two Gaussians on one motion: the product. Exp(e) takes odometry's to the measured one.
absl::Status MultiRobotMap::State::RefineMotion(const MotionMeasurement& measurement,
                                                int position) {
  const Matrix6d information = measurement.covariance.inverse();
  RETURN_IF_ERROR(SquareRootInformation(measurement.covariance).status());
  RETURN_IF_ERROR(SquareRootInformation(information).status());
  ChainMotion& motion = motions[position][measurement.to.index];
  const Matrix6d covariance = motion.covariance.Unpacked();
  const Vector6d error = Log(motion.previous_from_this.Inverse() * measurement.previous_from_this);
  const Matrix6d both = covariance + measurement.covariance;
  if (error.dot(both.ldlt().solve(error)) > options.consistency_chi_square_limit) {
    return absl::OkStatus();
  }
  const Matrix6d fused = (covariance.inverse() + information).inverse();
  motion.previous_from_this = motion.previous_from_this * Exp(fused * (information * error));
  motion.covariance = PackedCovariance(0.5 * (fused + fused.transpose()));
  const auto [entry, fresh] = refined.insert({position, measurement.to.index});
  if (!fresh) entry->second = std::min(entry->second, measurement.to.index);
  dirty = true;
  return absl::OkStatus();
}

// Up to it something beside odometry holds the mission's poses; -1: nothing does.
int64_t MultiRobotMap::State::LastTiedIndex(int position) const {
  const MissionId& mission = missions[position].id;
  int64_t last = -1;
  const auto tied = [&](const NodeId& node) {
    if (node.mission == mission) last = std::max(last, node.index);
  };
  for (const ClosureRecord& record : closures) {
    if (!InUse(record.verdict)) continue;
    tied(record.candidate.from);
    tied(record.candidate.to);
  }
  for (const SightingRecord& sighting : sightings) {
    if (sighting.pending || sighting.weight <= 0) continue;
    tied(sighting.observer);
    if (sighting.landmark.empty()) tied(sighting.target);
  }
  for (const AbsoluteRecord& absolute : absolutes) {
    if (absolute.weight > 0) tied(absolute.node);
  }
  return last;
}

// The path that closures are compared along, and the poses that only odometry holds as yet: the
// solver had better begin there than at the coarser ones. Closures compared before stay compared: a
// motion is refined with its keyframe's cloud, before candidates that end there come.
void MultiRobotMap::State::FollowRefinedMotions() {
  for (const auto& [position, first] : refined) {
    const ChainMotions& motions_of_mission = motions[position];
    UncertainTrajectory& path = odometry[position];
    path.Truncate(static_cast<int>(first));
    for (size_t i = first; i < motions_of_mission.size(); ++i) {
      path.Append(path.WorldFromBody(path.Size() - 1) * motions_of_mission[i].previous_from_this,
                  motions_of_mission[i].covariance.Unpacked());
    }
    chains[position].Forget(static_cast<int>(first));
    std::vector<Rigid3d>& poses = missions[position].map_from_body;
    for (size_t i = std::max(first, LastTiedIndex(position) + 1); i < poses.size(); ++i) {
      poses[i] = poses[i - 1] * motions_of_mission[i].previous_from_this;
    }
  }
  refined.clear();
}

absl::Status MultiRobotMap::AddMotion(const MotionMeasurement& motion) {
  const Rigid3d* pose = motion.to.index < 1 ? nullptr : state_->PoseOf(motion.to);
  if (pose == nullptr) {
    return absl::NotFoundError(absl::StrCat("to: no motion into ", ToString(motion.to)));
  }
  return state_->RefineMotion(motion, state_->PositionOf(motion.to));
}

}  // namespace overtone
