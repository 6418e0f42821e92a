// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/submap_conversion.h"

#include <utility>
#include <vector>

#include "absl/container/flat_hash_set.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/keyframe_conversion.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/proto/conversion/sighting_conversion.h"

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
  RETURN_IF_ERROR(
      ValidateCount("candidates", message.candidates_size(), 0, limits::kMaxCandidatesPerSubmap));
  RETURN_IF_ERROR(ValidateCount("clouds", message.clouds_size(), 0, limits::kMaxCloudsPerSubmap));
  RETURN_IF_ERROR(ValidateCount("landmark_sightings", message.landmark_sightings_size(), 0,
                                limits::kMaxSightingsPerSubmap));
  RETURN_IF_ERROR(ValidateCount("robot_sightings", message.robot_sightings_size(), 0,
                                limits::kMaxSightingsPerSubmap));
  RETURN_IF_ERROR(ValidateCount("absolute_poses", message.absolute_poses_size(), 0,
                                limits::kMaxAbsolutePosesPerSubmap));
  const int64_t last_index = message.first_index() + message.keyframes_size() - 1;
  return ValidateKeyframeIndex(last_index, "keyframes");
}

absl::Status AppendKeyframes(const v1::Submap& message, Submap& submap) {
  submap.keyframes.reserve(message.keyframes_size());
  for (int i = 0; i < message.keyframes_size(); ++i) {
    const bool first_of_mission = submap.first_index == 0 && i == 0;
    ASSIGN_OR_RETURN(Keyframe keyframe,
                     AtField("keyframes", i, FromProto(message.keyframes(i), first_of_mission)));
    if (i > 0 && keyframe.stamp <= submap.keyframes.back().stamp) {
      return InvalidField(absl::StrCat("keyframes[", i, "].stamp_ns"),
                          absl::StrCat(keyframe.stamp.ns, " is not after the previous keyframe's ",
                                       submap.keyframes.back().stamp.ns));
    }
    submap.keyframes.push_back(std::move(keyframe));
  }
  return absl::OkStatus();
}

// Closures and candidates: at least one end is in the mission.
template <typename Tie, typename Messages>
absl::Status AppendTies(absl::string_view field, const Messages& messages, const MissionId& mission,
                        std::vector<Tie>& ties) {
  ties.reserve(messages.size());
  for (int i = 0; i < messages.size(); ++i) {
    ASSIGN_OR_RETURN(Tie tie, AtField(field, i, FromProto(messages[i])));
    if (tie.from.mission != mission && tie.to.mission != mission) {
      return InvalidField(absl::StrCat(field, "[", i, "].from"),
                          absl::StrCat("neither end is in mission ", ToString(mission)));
    }
    ties.push_back(std::move(tie));
  }
  return absl::OkStatus();
}

// What belongs to one of the submap's own keyframes.
template <typename Item, typename Messages>
absl::Status AppendItems(absl::string_view field, const Messages& messages, const Submap& submap,
                         std::vector<Item>& items) {
  const int64_t first = submap.first_index;
  const int64_t last = first + static_cast<int64_t>(submap.keyframes.size()) - 1;
  items.reserve(messages.size());
  for (int i = 0; i < messages.size(); ++i) {
    ASSIGN_OR_RETURN(Item item, AtField(field, i, FromProto(messages[i])));
    if (item.index < first || item.index > last) {
      return InvalidField(
          absl::StrCat(field, "[", i, "].index"),
          absl::StrCat(item.index, " is not one of the submap's keyframes, ", first, " to ", last));
    }
    items.push_back(std::move(item));
  }
  return absl::OkStatus();
}

absl::Status ValidateOneCloudEach(const std::vector<KeyframeCloud>& clouds) {
  absl::flat_hash_set<int64_t> seen;
  for (size_t i = 0; i < clouds.size(); ++i) {
    if (seen.insert(clouds[i].index).second) continue;
    return InvalidField(absl::StrCat("clouds[", i, "].index"),
                        absl::StrCat("a second cloud of keyframe ", clouds[i].index));
  }
  return absl::OkStatus();
}

absl::Status ValidateOthers(const std::vector<RobotSighting>& sightings, const MissionId& mission) {
  for (size_t i = 0; i < sightings.size(); ++i) {
    if (sightings[i].robot != mission.robot) continue;
    return InvalidField(absl::StrCat("robot_sightings[", i, "].robot"),
                        absl::StrCat(mission.robot, " cannot see itself"));
  }
  return absl::OkStatus();
}

template <typename Item, typename Messages>
void WriteAll(const std::vector<Item>& items, Messages* messages) {
  for (const Item& item : items) *messages->Add() = ToProto(item);
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
    *message.add_keyframes() = ToProto(keyframe, first_of_mission);
  }
  WriteAll(submap.loop_closures, message.mutable_loop_closures());
  WriteAll(submap.candidates, message.mutable_candidates());
  WriteAll(submap.clouds, message.mutable_clouds());
  WriteAll(submap.landmark_sightings, message.mutable_landmark_sightings());
  WriteAll(submap.robot_sightings, message.mutable_robot_sightings());
  WriteAll(submap.absolute_poses, message.mutable_absolute_poses());
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
  RETURN_IF_ERROR(
      AppendTies("loop_closures", message.loop_closures(), mission, submap.loop_closures));
  RETURN_IF_ERROR(AppendTies("candidates", message.candidates(), mission, submap.candidates));
  RETURN_IF_ERROR(AppendItems("clouds", message.clouds(), submap, submap.clouds));
  RETURN_IF_ERROR(ValidateOneCloudEach(submap.clouds));
  RETURN_IF_ERROR(AppendItems("landmark_sightings", message.landmark_sightings(), submap,
                              submap.landmark_sightings));
  RETURN_IF_ERROR(
      AppendItems("robot_sightings", message.robot_sightings(), submap, submap.robot_sightings));
  RETURN_IF_ERROR(ValidateOthers(submap.robot_sightings, mission));
  RETURN_IF_ERROR(
      AppendItems("absolute_poses", message.absolute_poses(), submap, submap.absolute_poses));
  return submap;
}

}  // namespace overtone
