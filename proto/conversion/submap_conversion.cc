// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/submap_conversion.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {
namespace {

absl::Status ValidateCount(absl::string_view field, int count, int smallest, int largest) {
  if (count >= smallest && count <= largest) return absl::OkStatus();
  return InvalidField(field, absl::StrCat(count, " of them, not ", smallest, " to ", largest));
}

absl::Status ValidateHeader(const v1::Submap& message) {
  if (message.sequence() < 0 || message.sequence() > limits::kMaxSequence) {
    return InvalidField("sequence", absl::StrCat(message.sequence(), " is not in [0, 1e9]"));
  }
  RETURN_IF_ERROR(ValidateKeyframeIndex(message.first_index(), "first_index"));
  // Every submap before this one held at least one keyframe; before the first there was none.
  const bool possible = message.sequence() == 0 ? message.first_index() == 0
                                                : message.first_index() >= message.sequence();
  if (!possible) {
    return InvalidField("first_index", absl::StrCat(message.first_index(), " cannot be in submap ",
                                                    message.sequence()));
  }
  RETURN_IF_ERROR(
      ValidateCount("keyframes", message.keyframes_size(), 1, limits::kMaxKeyframesPerSubmap));
  RETURN_IF_ERROR(ValidateCount("loop_closures", message.loop_closures_size(), 0,
                                limits::kMaxLoopClosuresPerSubmap));
  const int64_t last_index = message.first_index() + message.keyframes_size() - 1;
  return ValidateKeyframeIndex(last_index, "keyframes");
}

absl::StatusOr<Keyframe> DecodeKeyframe(const v1::Keyframe& message, bool first_of_mission) {
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
  return keyframe;
}

absl::Status AppendKeyframes(const v1::Submap& message, Submap& submap) {
  submap.keyframes.reserve(message.keyframes_size());
  for (int i = 0; i < message.keyframes_size(); ++i) {
    const bool first_of_mission = submap.first_index == 0 && i == 0;
    ASSIGN_OR_RETURN(
        Keyframe keyframe,
        AtField("keyframes", i, DecodeKeyframe(message.keyframes(i), first_of_mission)));
    if (i > 0 && keyframe.stamp <= submap.keyframes.back().stamp) {
      return InvalidField(absl::StrCat("keyframes[", i, "].stamp_ns"),
                          absl::StrCat(keyframe.stamp.ns, " is not after the previous keyframe's ",
                                       submap.keyframes.back().stamp.ns));
    }
    submap.keyframes.push_back(std::move(keyframe));
  }
  return absl::OkStatus();
}

absl::Status AppendLoopClosures(const v1::Submap& message, const MissionId& mission,
                                Submap& submap) {
  submap.loop_closures.reserve(message.loop_closures_size());
  for (int i = 0; i < message.loop_closures_size(); ++i) {
    ASSIGN_OR_RETURN(LoopClosure closure,
                     AtField("loop_closures", i, FromProto(message.loop_closures(i))));
    if (closure.from.mission != mission && closure.to.mission != mission) {
      return InvalidField(absl::StrCat("loop_closures[", i, "].from"),
                          absl::StrCat("neither end is in mission ", ToString(mission)));
    }
    submap.loop_closures.push_back(std::move(closure));
  }
  return absl::OkStatus();
}

}  // namespace

v1::LoopClosure ToProto(const LoopClosure& closure) {
  v1::LoopClosure message;
  *message.mutable_from() = ToProto(closure.from);
  *message.mutable_to() = ToProto(closure.to);
  *message.mutable_from_tform_to() = ToProto(closure.from_tform_to);
  *message.mutable_covariance() = ToProto(closure.covariance);
  return message;
}

v1::Submap ToProto(const Submap& submap) {
  v1::Submap message;
  message.set_sequence(submap.sequence);
  message.set_first_index(submap.first_index);
  for (const Keyframe& keyframe : submap.keyframes) {
    const bool first_of_mission = submap.first_index == 0 && message.keyframes_size() == 0;
    v1::Keyframe& out = *message.add_keyframes();
    out.set_stamp_ns(keyframe.stamp.ns);
    *out.mutable_mission_tform_body() = ToProto(keyframe.mission_from_body);
    if (!first_of_mission) {
      *out.mutable_motion_covariance() = ToProto(keyframe.motion_covariance);
    }
    out.set_degenerate(keyframe.degenerate);
  }
  for (const LoopClosure& closure : submap.loop_closures) {
    *message.add_loop_closures() = ToProto(closure);
  }
  return message;
}

absl::StatusOr<LoopClosure> FromProto(const v1::LoopClosure& message) {
  LoopClosure closure;
  ASSIGN_OR_RETURN(closure.from, AtField("from", FromProto(message.from())));
  ASSIGN_OR_RETURN(closure.to, AtField("to", FromProto(message.to())));
  if (closure.from == closure.to) {
    return InvalidField("to", absl::StrCat("the same keyframe as from, ", ToString(closure.to)));
  }
  ASSIGN_OR_RETURN(closure.from_tform_to,
                   AtField("from_tform_to", FromProto(message.from_tform_to())));
  ASSIGN_OR_RETURN(closure.covariance, AtField("covariance", FromProto(message.covariance())));
  return closure;
}

absl::StatusOr<Submap> FromProto(const v1::Submap& message, const MissionId& mission) {
  RETURN_IF_ERROR(ValidateHeader(message));
  Submap submap;
  submap.sequence = message.sequence();
  submap.first_index = message.first_index();
  RETURN_IF_ERROR(AppendKeyframes(message, submap));
  RETURN_IF_ERROR(AppendLoopClosures(message, mission, submap));
  return submap;
}

}  // namespace overtone
