// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/load_recordings.h"

#include <set>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/simulation/example_team.h"

namespace overtone {
namespace {

absl::StatusOr<std::vector<Recording>> SimulateExample(const ReplayOptions& options) {
  ExampleTeamOptions team_options;
  team_options.duration_s = options.example_duration_s;
  team_options.seed = options.client.seed;
  ASSIGN_OR_RETURN(const std::vector<SimulatedRobot> team, SimulateExampleTeam(team_options));
  std::vector<Recording> recordings;
  for (const SimulatedRobot& robot : team) {
    Recording recording;
    recording.name = robot.name;
    ASSIGN_OR_RETURN(recording.id, MissionOf(robot.name));
    recording.odometry = robot.odometry;
    for (size_t i = 0; i < robot.odometry.size(); ++i) recording.frames.push_back(i);
    recording.ground_truth = robot.ground_truth;
    recording.common_from_world = Rigid3d::Identity();
    recordings.push_back(std::move(recording));
  }
  return recordings;
}

absl::StatusOr<std::vector<Recording>> ReadRecordings(const ReplayOptions& options) {
  if (options.robots.empty()) {
    return absl::InvalidArgumentError("--robot NAME:odometry[:ground_truth] is needed");
  }
  std::vector<Recording> recordings;
  std::set<MissionId> ids;
  for (const std::string& text : options.robots) {
    ASSIGN_OR_RETURN(const RobotSource source, ParseRobotSource(text));
    ASSIGN_OR_RETURN(Recording recording, ReadRecording(options.dataset, source));
    if (!ids.insert(recording.id).second) {
      return absl::InvalidArgumentError(absl::StrCat("--robot ", source.name, " is given twice"));
    }
    recordings.push_back(std::move(recording));
  }
  return recordings;
}

// Where the truth is not known, the recorded odometry stands for it. Each robot of several has a
// frame of its own then.
void TakeOdometryForTruth(std::vector<Recording>* recordings) {
  for (Recording& recording : *recordings) {
    if (!recording.ground_truth.empty()) continue;
    recording.ground_truth = recording.odometry;
    if (recordings->size() == 1) recording.common_from_world = Rigid3d::Identity();
  }
}

absl::StatusOr<std::vector<Recording>> ReadOrSimulate(const ReplayOptions& options) {
  if (options.dataset == DatasetKind::kExample) return SimulateExample(options);
  if (!IsSensorDataset(options.dataset)) return ReadRecordings(options);
  const absl::StatusOr<std::vector<Recording>> recordings =
      ReadSensorDataset(options.dataset, options.sensor_files);
  if (recordings.ok()) return recordings;
  return absl::Status(
      recordings.status().code(),
      absl::StrCat("--dataset ", options.dataset_name, ": ", recordings.status().message()));
}

}  // namespace

absl::StatusOr<LoadedRecordings> LoadRecordings(const ReplayOptions& options) {
  LoadedRecordings loaded;
  if (!options.inject_drift.empty()) {
    const absl::StatusOr<DriftInjection> drift = ParseDriftInjection(options.inject_drift);
    if (!drift.ok()) {
      return absl::InvalidArgumentError(absl::StrCat("--inject-drift: ", drift.status().message()));
    }
    loaded.drift = *drift;
  }
  std::vector<Recording>& recordings = loaded.recordings;
  ASSIGN_OR_RETURN(recordings, ReadOrSimulate(options));
  RETURN_IF_ERROR(ApplyAlignments(options.alignments, &recordings));
  if (loaded.drift.has_value()) TakeOdometryForTruth(&recordings);
  if (options.split > 1) {
    if (recordings.size() != 1) return absl::InvalidArgumentError("--split takes one robot");
    const Recording whole = std::move(recordings[0]);
    ASSIGN_OR_RETURN(recordings, SplitRecording(whole, options.split, options.overlap));
  }
  for (size_t i = 0; i < recordings.size() && loaded.drift.has_value(); ++i) {
    InjectDrift(*loaded.drift, i, &recordings[i]);
  }
  if (!options.mission.empty()) {
    RETURN_IF_ERROR(ValidateId(options.mission, "--mission"));
    for (Recording& recording : recordings) recording.id.mission = options.mission;
  }
  return loaded;
}

}  // namespace overtone
