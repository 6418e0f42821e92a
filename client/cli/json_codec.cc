// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/json_codec.h"

#include <array>
#include <stdexcept>

#include "absl/strings/str_cat.h"
#include "overtone/core/geometry/parse_pose.h"

namespace overtone {
namespace {

template <typename Enum>
Enum FromName(const std::string& name, std::initializer_list<Enum> values) {
  for (const Enum value : values) {
    if (ToString(value) == name) return value;
  }
  throw std::invalid_argument("unknown name \"" + name + "\"");
}

}  // namespace

absl::string_view ToString(ConstraintAction action) {
  switch (action) {
    case ConstraintAction::kAdd:
      return "add";
    case ConstraintAction::kUpdate:
      return "update";
    case ConstraintAction::kRetract:
      return "retract";
  }
  return "";
}

Json ToJson(const NodeId& id) { return {id.mission.robot, id.mission.mission, id.index}; }

// Json::get casts whatever number is there, which is undefined beyond the type's range.
int64_t IntegerFromJson(const Json& json) {
  const bool fits =
      json.is_number_integer() && (!json.is_number_unsigned() || json.get<uint64_t>() <= INT64_MAX);
  if (!fits) throw std::invalid_argument(json.dump() + " is not an integer below 2^63");
  return json.get<int64_t>();
}

NodeId NodeIdFromJson(const Json& json) {
  return {{json.at(0).get<std::string>(), json.at(1).get<std::string>()},
          IntegerFromJson(json.at(2))};
}

Json ToJson(const Rigid3d& pose) {
  const Eigen::Vector3d& p = pose.translation;
  const Eigen::Quaterniond& q = pose.rotation;
  return {p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w()};
}

Json ToJson(const Matrix6d& covariance) {
  Json json = Json::array();
  for (int row = 0; row < 6; ++row) {
    for (int col = row; col < 6; ++col) json.push_back(covariance(row, col));
  }
  return json;
}

Json ToJson(const Keyframe& keyframe) {
  Json json = {{"stamp_ns", keyframe.stamp.ns},
               {"mission_tform_body", ToJson(keyframe.mission_from_body)},
               {"motion_covariance", ToJson(keyframe.motion_covariance)},
               {"degenerate", keyframe.degenerate}};
  const Eigen::Vector3d& direction = keyframe.degenerate_direction;
  if (!direction.isZero(0)) {
    json["degenerate_direction"] = {direction.x(), direction.y(), direction.z()};
  }
  return json;
}

Json ToJson(const LoopClosure& closure) {
  return {{"from", ToJson(closure.from)},
          {"to", ToJson(closure.to)},
          {"from_tform_to", ToJson(closure.from_tform_to)},
          {"covariance", ToJson(closure.covariance)}};
}

Json ToJson(const Constraint& constraint) {
  return {{"id", constraint.id},
          {"kind", std::string(ToString(constraint.kind))},
          {"from", constraint.from},
          {"to", constraint.to},
          {"from_tform_to", ToJson(constraint.from_tform_to)},
          {"covariance", ToJson(constraint.covariance)},
          {"score", constraint.score},
          {"revision", constraint.revision}};
}

Json ToJson(const ConstraintRecord& record) {
  return {{"action", std::string(ToString(record.action))},
          {"time_s", record.time_s},
          {"constraint", ToJson(record.constraint)}};
}

Rigid3d PoseFromJson(const Json& json) {
  const auto v = json.get<std::array<double, 7>>();
  const absl::StatusOr<Rigid3d> pose =
      CheckedPose(Eigen::Vector3d(v[0], v[1], v[2]), Eigen::Vector4d(v[3], v[4], v[5], v[6]));
  if (!pose.ok()) throw std::invalid_argument(std::string(pose.status().message()));
  return *pose;
}

Matrix6d CovarianceFromJson(const Json& json) {
  const auto v = json.get<std::array<double, 21>>();
  Matrix6d covariance;
  int i = 0;
  for (int row = 0; row < 6; ++row) {
    for (int col = row; col < 6; ++col) covariance(row, col) = covariance(col, row) = v[i++];
  }
  return covariance;
}

Keyframe KeyframeFromJson(const Json& json) {
  Keyframe keyframe;
  keyframe.stamp.ns = IntegerFromJson(json.at("stamp_ns"));
  keyframe.mission_from_body = PoseFromJson(json.at("mission_tform_body"));
  keyframe.motion_covariance = CovarianceFromJson(json.at("motion_covariance"));
  keyframe.degenerate = json.value("degenerate", false);
  const auto direction = json.value("degenerate_direction", std::array<double, 3>{0, 0, 0});
  keyframe.degenerate_direction = Eigen::Vector3d(direction[0], direction[1], direction[2]);
  return keyframe;
}

LoopClosure LoopClosureFromJson(const Json& json) {
  return {NodeIdFromJson(json.at("from")), NodeIdFromJson(json.at("to")),
          PoseFromJson(json.at("from_tform_to")), CovarianceFromJson(json.at("covariance"))};
}

Constraint ConstraintFromJson(const Json& json) {
  Constraint constraint;
  constraint.id = json.at("id").get<std::string>();
  constraint.kind = FromName(json.at("kind").get<std::string>(),
                             {ConstraintKind::kSmall, ConstraintKind::kMid, ConstraintKind::kLarge,
                              ConstraintKind::kDegenerate, ConstraintKind::kChord});
  constraint.from = IntegerFromJson(json.at("from"));
  constraint.to = IntegerFromJson(json.at("to"));
  constraint.from_tform_to = PoseFromJson(json.at("from_tform_to"));
  constraint.covariance = CovarianceFromJson(json.at("covariance"));
  constraint.score = json.at("score").get<double>();
  constraint.revision = static_cast<uint64_t>(IntegerFromJson(json.at("revision")));
  return constraint;
}

ConstraintRecord ConstraintRecordFromJson(const Json& json) {
  ConstraintRecord record;
  record.action =
      FromName(json.at("action").get<std::string>(),
               {ConstraintAction::kAdd, ConstraintAction::kUpdate, ConstraintAction::kRetract});
  record.time_s = json.at("time_s").get<double>();
  record.constraint = ConstraintFromJson(json.at("constraint"));
  return record;
}

absl::Status Decode(const std::string& text, const std::string& source,
                    const std::function<void(const Json&)>& decode) {
  try {
    decode(Json::parse(text));
    return absl::OkStatus();
  } catch (const std::exception& error) {
    return absl::InvalidArgumentError(absl::StrCat(source, ": ", error.what()));
  }
}

}  // namespace overtone
