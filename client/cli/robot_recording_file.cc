// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/robot_recording_file.h"

#include <fstream>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "overtone/client/cli/json_codec.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

absl::Status Validate(const RobotRecording& recording) {
  RETURN_IF_ERROR(ValidateId(recording.id.robot, "robot"));
  RETURN_IF_ERROR(ValidateId(recording.id.mission, "mission"));
  if (recording.keyframes.empty()) return absl::InvalidArgumentError("keyframes: empty");
  const int64_t count = static_cast<int64_t>(recording.keyframes.size());
  for (const LoopClosure& closure : recording.closures) {
    for (const NodeId& end : {closure.from, closure.to}) {
      if (end.mission == recording.id && (end.index < 0 || end.index >= count)) {
        return absl::InvalidArgumentError(
            absl::StrCat("loop_closures: no keyframe ", ToString(end)));
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status WriteRobotRecording(const std::string& path, const RobotRecording& recording) {
  Json json = {{"robot", recording.id.robot},
               {"mission", recording.id.mission},
               {"keyframes", Json::array()},
               {"loop_closures", Json::array()}};
  for (const Keyframe& keyframe : recording.keyframes)
    json["keyframes"].push_back(ToJson(keyframe));
  for (const LoopClosure& closure : recording.closures) {
    json["loop_closures"].push_back(ToJson(closure));
  }
  std::ofstream file(path);
  file << json.dump() << "\n";
  file.close();
  if (!file) return absl::UnavailableError(absl::StrCat("cannot write ", path));
  return absl::OkStatus();
}

absl::StatusOr<RobotRecording> ReadRobotRecording(const std::string& path) {
  std::ifstream file(path);
  if (!file) return absl::NotFoundError(absl::StrCat(path, ": cannot be opened"));
  std::ostringstream text;
  text << file.rdbuf();
  RobotRecording recording;
  RETURN_IF_ERROR(Decode(text.str(), path, [&recording](const Json& json) {
    recording.id.robot = json.at("robot").get<std::string>();
    recording.id.mission = json.at("mission").get<std::string>();
    for (const Json& keyframe : json.at("keyframes")) {
      recording.keyframes.push_back(KeyframeFromJson(keyframe));
    }
    for (const Json& closure : json.at("loop_closures")) {
      recording.closures.push_back(LoopClosureFromJson(closure));
    }
  }));
  if (absl::Status status = Validate(recording); !status.ok()) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": ", status.message()));
  }
  return recording;
}

}  // namespace overtone
