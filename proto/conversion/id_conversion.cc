// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/id_conversion.h"

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {

v1::MissionId ToProto(const MissionId& id) {
  v1::MissionId message;
  message.set_robot(id.robot);
  message.set_mission(id.mission);
  return message;
}

v1::NodeId ToProto(const NodeId& id) {
  v1::NodeId message;
  *message.mutable_mission() = ToProto(id.mission);
  message.set_index(id.index);
  return message;
}

absl::StatusOr<MissionId> FromProto(const v1::MissionId& message) {
  RETURN_IF_ERROR(ValidateId(message.robot(), "robot"));
  RETURN_IF_ERROR(ValidateId(message.mission(), "mission"));
  return MissionId{message.robot(), message.mission()};
}

absl::StatusOr<NodeId> FromProto(const v1::NodeId& message) {
  ASSIGN_OR_RETURN(MissionId mission, AtField("mission", FromProto(message.mission())));
  RETURN_IF_ERROR(ValidateKeyframeIndex(message.index(), "index"));
  return NodeId{std::move(mission), message.index()};
}

absl::Status ValidateKeyframeIndex(int64_t index, absl::string_view field) {
  if (index >= 0 && index <= limits::kMaxKeyframeIndex) return absl::OkStatus();
  return InvalidField(field,
                      absl::StrCat(index, " is not in [0, ", limits::kMaxKeyframeIndex, "]"));
}

absl::StatusOr<Timestamp> StampFromNanoseconds(int64_t stamp_ns, absl::string_view field) {
  if (stamp_ns >= 0 && stamp_ns <= limits::kMaxStampNs) return Timestamp{stamp_ns};
  return InvalidField(field, absl::StrCat(stamp_ns, " ns is not in [0, 4e18]"));
}

}  // namespace overtone
