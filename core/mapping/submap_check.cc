// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/submap_check.h"

#include <cmath>

#include "Eigen/LU"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/estimation/square_root_information.h"

namespace overtone {
namespace {

// Beyond any map on Earth, yet far from where doubles lose millimetres.
constexpr double kLargestCoordinateM = 1e8;
constexpr double kUnitLengthTolerance = 1e-6;

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

absl::Status CheckCovariance(const Matrix6d& covariance, absl::string_view field) {
  if (!covariance.allFinite()) return Invalid(field, "not finite");
  // Both must factorise: a covariance may be so small or so ill-conditioned that its inverse is
  // useless.
  if (covariance.llt().info() != Eigen::Success || !SquareRootInformation(covariance).ok() ||
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
    if (submap.first_index + static_cast<int64_t>(i) == 0) continue;
    RETURN_IF_ERROR(CheckCovariance(keyframe.motion_covariance, field + ".motion_covariance"));
  }
  return absl::OkStatus();
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
  for (size_t k = 0; k < submap.loop_closures.size(); ++k) {
    const LoopClosure& closure = submap.loop_closures[k];
    const std::string field = absl::StrCat("loop_closures[", k, "]");
    if (closure.from.mission != mission && closure.to.mission != mission) {
      return Invalid(field, "neither end is in the submap's mission");
    }
    const absl::Status status = CheckLoopClosure(closure);
    if (!status.ok()) return Invalid(field, status.message());
  }
  return absl::OkStatus();
}

}  // namespace overtone
