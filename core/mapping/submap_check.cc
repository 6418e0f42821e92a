// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/submap_check.h"

#include <cmath>
#include <set>
#include <string>
#include <vector>

#include "Eigen/LU"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/estimation/square_root_information.h"
#include "overtone/core/geometry/positive_definite.h"

namespace overtone {
namespace {

// Beyond any map on Earth, yet far from where doubles lose millimetres.
constexpr double kLargestCoordinateM = 1e8;
constexpr double kUnitLengthTolerance = 1e-6;
constexpr double kDirectionTolerance = 1e-3;

absl::Status Invalid(absl::string_view field, absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat(field, ": ", what));
}

absl::Status CheckPose(const Rigid3d& pose, absl::string_view field) {
  if (!pose.rotation.coeffs().allFinite() || !pose.translation.allFinite()) {
    return Invalid(field, "not finite");
  }
  if (std::abs(pose.rotation.norm() - 1) > kUnitLengthTolerance) {
    return Invalid(field, "quaternion is not of unit length");
  }
  if (pose.translation.cwiseAbs().maxCoeff() > kLargestCoordinateM) {
    return Invalid(field, "translation exceeds 1e8 m");
  }
  return absl::OkStatus();
}

absl::Status CheckPointCovariance(const Eigen::Matrix3d& covariance, absl::string_view field) {
  const bool symmetric = covariance.allFinite() && covariance.isApprox(covariance.transpose());
  const Eigen::Matrix3d information = covariance.inverse();
  if (symmetric && IsPositiveDefinite(covariance) && IsPositiveDefinite(information)) {
    return absl::OkStatus();
  }
  return Invalid(field, "not symmetric positive definite");
}

absl::Status CheckCovariance(const Matrix6d& covariance, absl::string_view field) {
  if (!covariance.allFinite()) return Invalid(field, "not finite");
  // Both must factorise: a covariance may be so small or so ill-conditioned that its inverse is
  // useless.
  if (!IsPositiveDefinite(covariance) || !SquareRootInformation(covariance).ok() ||
      !SquareRootInformation(Matrix6d(covariance.inverse())).ok()) {
    return Invalid(field, "not symmetric positive definite");
  }
  return absl::OkStatus();
}

absl::Status CheckKeyframes(const Submap& submap) {
  for (size_t i = 0; i < submap.keyframes.size(); ++i) {
    const Keyframe& keyframe = submap.keyframes[i];
    const std::string field = absl::StrCat("keyframes[", i, "]");
    if (i > 0 && !(submap.keyframes[i - 1].stamp < keyframe.stamp)) {
      return Invalid(field + ".stamp", "does not increase");
    }
    RETURN_IF_ERROR(CheckPose(keyframe.mission_from_body, field + ".mission_from_body"));
    const Eigen::Vector3d& direction = keyframe.degenerate_direction;
    if (!direction.isZero(0) &&
        !(keyframe.degenerate && std::abs(direction.norm() - 1) <= kDirectionTolerance)) {
      return Invalid(field + ".degenerate_direction", "not of unit length, or without degenerate");
    }
    if (submap.first_index + static_cast<int64_t>(i) == 0) continue;
    RETURN_IF_ERROR(CheckCovariance(keyframe.motion_covariance, field + ".motion_covariance"));
  }
  return absl::OkStatus();
}

absl::Status CheckCandidate(const ScoredCandidate& candidate) {
  if (candidate.from == candidate.to) return Invalid("to", "both ends are the same keyframe");
  if (candidate.from.index < 0) return Invalid("from.index", "negative");
  if (candidate.to.index < 0) return Invalid("to.index", "negative");
  if (candidate.score >= 0 && candidate.score <= 1) return absl::OkStatus();  // false for NaN
  return Invalid("score", "not in [0, 1]");
}

absl::Status CheckPoint(const Eigen::Vector3d& point_in_body, const Eigen::Matrix3d& covariance) {
  if (!point_in_body.allFinite() || point_in_body.cwiseAbs().maxCoeff() > kLargestCoordinateM) {
    return Invalid("point_in_body", "not finite, or exceeds 1e8 m");
  }
  return CheckPointCovariance(covariance, "covariance");
}

// Closures and candidates: `check` each, and that one end is in the mission.
template <typename Tie>
absl::Status CheckTies(absl::string_view name, const std::vector<Tie>& ties,
                       const MissionId& mission, absl::Status (*check)(const Tie&)) {
  for (size_t k = 0; k < ties.size(); ++k) {
    const std::string field = absl::StrCat(name, "[", k, "]");
    if (ties[k].from.mission != mission && ties[k].to.mission != mission) {
      return Invalid(field, "neither end is in the submap's mission");
    }
    const absl::Status status = check(ties[k]);
    if (!status.ok()) return Invalid(field, status.message());
  }
  return absl::OkStatus();
}

// What belongs to one of the submap's keyframes: `check` each, and its index.
template <typename Item, typename Check>
absl::Status CheckItems(absl::string_view name, const std::vector<Item>& items,
                        const Submap& submap, const Check& check) {
  const int64_t end = submap.first_index + static_cast<int64_t>(submap.keyframes.size());
  for (size_t k = 0; k < items.size(); ++k) {
    const std::string field = absl::StrCat(name, "[", k, "]");
    if (items[k].index < submap.first_index || items[k].index >= end) {
      return Invalid(field, "index: none of the submap's keyframes");
    }
    const absl::Status status = check(items[k]);
    if (!status.ok()) return Invalid(field, status.message());
  }
  return absl::OkStatus();
}

absl::Status CheckBelongings(const MissionId& mission, const Submap& submap) {
  std::set<int64_t> with_cloud;
  RETURN_IF_ERROR(CheckItems("clouds", submap.clouds, submap, [&](const KeyframeCloud& cloud) {
    if (with_cloud.insert(cloud.index).second) return absl::OkStatus();
    return Invalid("index", "a second cloud of this keyframe");
  }));
  RETURN_IF_ERROR(CheckItems("landmark_sightings", submap.landmark_sightings, submap,
                             [](const LandmarkSighting& sighting) {
                               RETURN_IF_ERROR(ValidateId(sighting.landmark, "landmark"));
                               return CheckPoint(sighting.point_in_body, sighting.covariance);
                             }));
  RETURN_IF_ERROR(CheckItems("robot_sightings", submap.robot_sightings, submap,
                             [&](const RobotSighting& sighting) {
                               RETURN_IF_ERROR(ValidateId(sighting.robot, "robot"));
                               if (sighting.robot == mission.robot) {
                                 return Invalid("robot", "it cannot see itself");
                               }
                               return CheckPoint(sighting.point_in_body, sighting.covariance);
                             }));
  return CheckItems("absolute_poses", submap.absolute_poses, submap, [](const AbsolutePose& pose) {
    RETURN_IF_ERROR(CheckPose(pose.map_from_body, "map_from_body"));
    return CheckCovariance(pose.covariance, "covariance");
  });
}

}  // namespace

absl::Status CheckLoopClosure(const LoopClosure& closure) {
  if (closure.from == closure.to) return Invalid("to", "both ends are the same keyframe");
  if (closure.from.index < 0) return Invalid("from.index", "negative");
  if (closure.to.index < 0) return Invalid("to.index", "negative");
  RETURN_IF_ERROR(CheckPose(closure.from_tform_to, "from_tform_to"));
  return CheckCovariance(closure.covariance, "covariance");
}

absl::Status CheckSubmap(const MissionId& mission, const Submap& submap) {
  if (submap.keyframes.empty()) return Invalid("keyframes", "empty");
  RETURN_IF_ERROR(CheckKeyframes(submap));
  RETURN_IF_ERROR(CheckTies("loop_closures", submap.loop_closures, mission, CheckLoopClosure));
  RETURN_IF_ERROR(CheckTies("candidates", submap.candidates, mission, CheckCandidate));
  return CheckBelongings(mission, submap);
}

}  // namespace overtone
