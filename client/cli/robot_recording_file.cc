// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/robot_recording_file.h"

#include <fstream>
#include <sstream>

#include "absl/strings/str_cat.h"
#include "overtone/client/cli/observation_codec.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

absl::Status ValidateEnds(const RobotRecording& recording, absl::string_view field,
                          const NodeId& from, const NodeId& to) {
  const int64_t count = static_cast<int64_t>(recording.keyframes.size());
  for (const NodeId& end : {from, to}) {
    if (end.mission == recording.id && (end.index < 0 || end.index >= count)) {
      return absl::InvalidArgumentError(absl::StrCat(field, ": no keyframe ", ToString(end)));
    }
  }
  return absl::OkStatus();
}

template <typename Observation>
absl::Status ValidateIndices(absl::string_view field, const std::vector<Observation>& observations,
                             size_t keyframes) {
  for (const Observation& observation : observations) {
    if (observation.index < 0 || observation.index >= static_cast<int64_t>(keyframes)) {
      return absl::InvalidArgumentError(absl::StrCat(field, ": no keyframe ", observation.index));
    }
  }
  return absl::OkStatus();
}

absl::Status ValidateObservations(const Observations& observations, size_t keyframes) {
  RETURN_IF_ERROR(ValidateIndices("clouds", observations.clouds, keyframes));
  RETURN_IF_ERROR(
      ValidateIndices("landmark_sightings", observations.landmark_sightings, keyframes));
  RETURN_IF_ERROR(ValidateIndices("robot_sightings", observations.robot_sightings, keyframes));
  return ValidateIndices("absolute_poses", observations.absolute_poses, keyframes);
}

absl::Status Validate(const RobotRecording& recording) {
  RETURN_IF_ERROR(ValidateId(recording.id.robot, "robot"));
  RETURN_IF_ERROR(ValidateId(recording.id.mission, "mission"));
  if (recording.keyframes.empty()) return absl::InvalidArgumentError("keyframes: empty");
  for (const LoopClosure& closure : recording.closures) {
    RETURN_IF_ERROR(ValidateEnds(recording, "loop_closures", closure.from, closure.to));
  }
  for (const ScoredCandidate& candidate : recording.candidates) {
    RETURN_IF_ERROR(ValidateEnds(recording, "candidates", candidate.from, candidate.to));
  }
  return ValidateObservations(recording.observations, recording.keyframes.size());
}

}  // namespace

absl::Status WriteRobotRecording(const std::string& path, const RobotRecording& recording) {
  Json json = {{"robot", recording.id.robot}, {"mission", recording.id.mission},
               {"keyframes", Json::array()},  {"loop_closures", Json::array()},
               {"candidates", Json::array()}, {"observations", ToJson(recording.observations)}};
  for (const Keyframe& keyframe : recording.keyframes)
    json["keyframes"].push_back(ToJson(keyframe));
  for (const LoopClosure& closure : recording.closures) {
    json["loop_closures"].push_back(ToJson(closure));
  }
  for (const ScoredCandidate& candidate : recording.candidates) {
    json["candidates"].push_back(ToJson(candidate));
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
    for (const Json& candidate : json.value("candidates", Json::array())) {
      recording.candidates.push_back(ScoredCandidateFromJson(candidate));
    }
    recording.observations = ObservationsFromJson(json.value("observations", Json::object()));
  }));
  if (absl::Status status = Validate(recording); !status.ok()) {
    return absl::InvalidArgumentError(absl::StrCat(path, ": ", status.message()));
  }
  return recording;
}

}  // namespace overtone
