// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/replay_input.h"

#include <map>
#include <set>
#include <utility>

#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "overtone/client/cli/closure_file.h"
#include "overtone/client/cli/g2o_recording.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/simulation/example_team.h"

namespace overtone {
namespace {

// The example's robots meet at street corners; a front end of their own would see some of that.
constexpr char kExampleClosures[] =
    "radius=1,sigma_t=0.05,sigma_r=0.01,outliers=0,density=0.3,max_per_keyframe=1";

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

absl::StatusOr<std::vector<Recording>> Load(const ReplayOptions& options) {
  if (options.dataset == DatasetKind::kExample) return SimulateExample(options);
  ASSIGN_OR_RETURN(std::vector<Recording> recordings, ReadRecordings(options));
  RETURN_IF_ERROR(ApplyAlignments(options.alignments, &recordings));
  if (options.split == 1) return recordings;
  if (recordings.size() != 1) return absl::InvalidArgumentError("--split takes one --robot");
  return SplitRecording(recordings[0], options.split, options.overlap);
}

absl::StatusOr<std::vector<RobotPlan>> MakePlans(const ReplayOptions& options,
                                                 const std::vector<Recording>& recordings) {
  const DatasetDefaults defaults = DefaultsOf(options.dataset);
  KeyframeSelectionOptions keyframes = defaults.keyframes;
  keyframes.min_distance_m = options.keyframe_distance_m.value_or(keyframes.min_distance_m);
  keyframes.min_rotation_rad = options.keyframe_rotation_rad.value_or(keyframes.min_rotation_rad);
  RETURN_IF_ERROR(keyframes.Validate());
  const absl::StatusOr<MotionNoise> noise =
      ParseMotionNoise(options.odometry_sigma, defaults.noise);
  if (!noise.ok()) {
    return absl::InvalidArgumentError(absl::StrCat("--odometry-sigma: ", noise.status().message()));
  }
  std::vector<RobotPlan> plans;
  for (const Recording& recording : recordings) {
    ASSIGN_OR_RETURN(RobotPlan plan, MakeRobotPlan(recording, keyframes, *noise));
    plans.push_back(std::move(plan));
  }
  return plans;
}

void AddMeasured(const std::vector<LoopClosure>& closures, ReplayInput* input) {
  for (const LoopClosure& closure : closures) input->closures.push_back({closure, false, false});
}

absl::Status AddFromFile(const ReplayOptions& options, ReplayInput* input) {
  if (absl::EndsWith(options.closures_file, ".g2o")) {
    ASSIGN_OR_RETURN(const std::vector<FrameClosure> closures,
                     ReadG2oClosures(options.closures_file,
                                     /*kitti_camera=*/options.dataset == DatasetKind::kKitti));
    AddMeasured(PlaceClosures(closures, input->plans), input);
  } else {
    ASSIGN_OR_RETURN(const std::vector<LoopClosure> closures,
                     ReadClosures(options.closures_file, input->plans));
    AddMeasured(closures, input);
  }
  absl::StrAppend(&input->closures_note, "Loop closures are those of ", options.closures_file,
                  ". ");
  return absl::OkStatus();
}

absl::Status AddSimulated(const ReplayOptions& options, ReplayInput* input) {
  std::string rule = options.closures_from_ground_truth;
  const bool given = !rule.empty() || !options.closures_file.empty();
  if (options.dataset == DatasetKind::kExample && !given) rule = kExampleClosures;
  if (rule.empty()) return absl::OkStatus();
  const absl::StatusOr<ClosureSimulationOptions> simulation =
      ParseClosureSimulation(absl::StrCat("seed=", options.client.seed, ",", rule));
  if (!simulation.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--closures-from-ground-truth: ", simulation.status().message()));
  }
  const std::vector<SimulatedClosure> closures = SimulateClosures(input->plans, *simulation);
  if (closures.empty()) {
    return absl::InvalidArgumentError(
        "--closures-from-ground-truth: no two keyframes with ground truth meet by this rule");
  }
  for (const SimulatedClosure& closure : closures) {
    input->closures.push_back({closure.closure, true, closure.outlier});
  }
  input->closures_simulated = true;
  absl::StrAppend(&input->closures_note, Describe(*simulation), " ");
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<ReplayInput> MakeReplayInput(const ReplayOptions& options) {
  ASSIGN_OR_RETURN(const std::vector<Recording> recordings, Load(options));
  ReplayInput input;
  ASSIGN_OR_RETURN(input.plans, MakePlans(options, recordings));
  for (size_t i = 0; i < recordings.size() && options.split == 1; ++i) {
    AddMeasured(PlaceClosures(recordings[i].closures, {input.plans[i]}), &input);
  }
  if (options.split > 1) AddMeasured(PlaceClosures(recordings[0].closures, input.plans), &input);
  if (!input.closures.empty()) {
    input.closures_note = "Loop closures are those of the g2o files. ";
  }
  if (!options.closures_file.empty()) RETURN_IF_ERROR(AddFromFile(options, &input));
  RETURN_IF_ERROR(AddSimulated(options, &input));
  if (input.closures.empty()) input.closures_note = "There are no loop closures.";
  return input;
}

std::vector<RobotRecording> MakeRecordings(const ReplayInput& input) {
  std::vector<RobotRecording> recordings;
  std::map<MissionId, int> robot_of;
  for (const RobotPlan& plan : input.plans) {
    robot_of[plan.id] = static_cast<int>(recordings.size());
    recordings.push_back({plan.id, plan.keyframes, {}});
  }
  for (const InputClosure& closure : input.closures) {
    const int from = robot_of.at(closure.closure.from.mission);
    const int to = robot_of.at(closure.closure.to.mission);
    const double from_time = input.plans[from].TimeOf(static_cast<int>(closure.closure.from.index));
    const double to_time = input.plans[to].TimeOf(static_cast<int>(closure.closure.to.index));
    recordings[from_time > to_time ? from : to].closures.push_back(closure.closure);
  }
  return recordings;
}

}  // namespace overtone
