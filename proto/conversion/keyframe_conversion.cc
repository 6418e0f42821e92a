// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/keyframe_conversion.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {
namespace {

absl::StatusOr<Eigen::Vector3d> DegenerateDirection(const v1::Keyframe& message) {
  if (!message.has_degenerate_direction()) return Eigen::Vector3d(Eigen::Vector3d::Zero());
  if (!message.degenerate()) {
    return InvalidField("degenerate_direction", "the keyframe is not degenerate");
  }
  const v1::Vector3& v = message.degenerate_direction();
  const Eigen::Vector3d direction(v.x(), v.y(), v.z());
  const double length = direction.norm();
  if (std::abs(length - 1) <= limits::kDirectionTolerance) return direction;  // false for NaN
  return InvalidField("degenerate_direction", absl::StrCat("length ", length, ", not 1"));
}

}  // namespace

v1::Keyframe ToProto(const Keyframe& keyframe, bool first_of_mission) {
  v1::Keyframe message;
  message.set_stamp_ns(keyframe.stamp.ns);
  *message.mutable_mission_tform_body() = ToProto(keyframe.mission_from_body);
  if (!first_of_mission) {
    *message.mutable_motion_covariance() = ToProto(keyframe.motion_covariance);
  }
  message.set_degenerate(keyframe.degenerate);
  if (!keyframe.degenerate_direction.isZero(0)) {
    *message.mutable_degenerate_direction() = ToProto(keyframe.degenerate_direction);
  }
  return message;
}

absl::StatusOr<Keyframe> FromProto(const v1::Keyframe& message, bool first_of_mission) {
  Keyframe keyframe;
  ASSIGN_OR_RETURN(keyframe.stamp, StampFromNanoseconds(message.stamp_ns(), "stamp_ns"));
  ASSIGN_OR_RETURN(keyframe.mission_from_body,
                   AtField("mission_tform_body", FromProto(message.mission_tform_body())));
  if (message.has_motion_covariance()) {
    ASSIGN_OR_RETURN(keyframe.motion_covariance,
                     AtField("motion_covariance", FromProto(message.motion_covariance())));
  } else if (!first_of_mission) {
    return InvalidField("motion_covariance", "missing");
  }
  keyframe.degenerate = message.degenerate();
  ASSIGN_OR_RETURN(keyframe.degenerate_direction, DegenerateDirection(message));
  return keyframe;
}

}  // namespace overtone
