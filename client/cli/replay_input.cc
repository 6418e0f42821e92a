// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/replay_input.h"

#include <map>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "overtone/client/cli/closure_file.h"
#include "overtone/client/cli/g2o_recording.h"
#include "overtone/client/cli/load_recordings.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

// The example's robots meet at street corners; a front end of their own would see some of that.
constexpr char kExampleClosures[] =
    "radius=1,sigma_t=0.05,sigma_r=0.01,outliers=0,density=0.3,max_per_keyframe=1";

absl::StatusOr<std::vector<RobotPlan>> MakePlans(const ReplayOptions& options,
                                                 const LoadedRecordings& loaded) {
  DatasetDefaults defaults = DefaultsOf(options.dataset);
  if (loaded.drift.has_value()) defaults.noise = WithDrift(defaults.noise, *loaded.drift);
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
  for (const Recording& recording : loaded.recordings) {
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

// What came with the recordings: of each for its own robot, of one that was cut for all its parts.
void AddRecorded(const ReplayOptions& options, const std::vector<Recording>& recordings,
                 ReplayInput* input) {
  const bool cut = options.split > 1;
  for (size_t i = 0; i < (cut ? 1 : recordings.size()); ++i) {
    const std::vector<RobotPlan> own =
        cut ? std::vector<RobotPlan>() : std::vector<RobotPlan>{input->plans[i]};
    const std::vector<RobotPlan>& plans = cut ? input->plans : own;
    AddMeasured(PlaceClosures(recordings[i].closures, plans), input);
    for (const ScoredCandidate& candidate : PlaceCandidates(recordings[i].candidates, plans)) {
      input->candidates.push_back(candidate);
    }
    for (const LoopClosure& relation : PlaceClosures(recordings[i].relations, plans)) {
      input->relations.push_back(relation);
    }
  }
  if (!input->closures.empty()) {
    input->closures_note = "Loop closures are those of the g2o files. ";
  }
}

// "Robots send 15383 sightings of landmarks, 3988 sightings of other robots. ", or nothing.
std::string DescribeObservations(const ReplayInput& input) {
  size_t clouds = 0, landmarks = 0, robots = 0, poses = 0;
  for (const RobotPlan& plan : input.plans) {
    clouds += plan.observations.clouds.size();
    landmarks += plan.observations.landmark_sightings.size();
    robots += plan.observations.robot_sightings.size();
    poses += plan.observations.absolute_poses.size();
  }
  std::vector<std::string> parts;
  const auto add = [&parts](size_t count, absl::string_view what) {
    if (count > 0) parts.push_back(absl::StrCat(count, " ", what));
  };
  add(clouds, "point clouds, in which the server looks for loop closures itself");
  add(input.candidates.size(), "scored candidates of the robots' front ends");
  add(landmarks, "sightings of landmarks");
  add(robots, "sightings of other robots");
  add(poses, "absolute poses");
  return parts.empty() ? "" : absl::StrCat("Robots send ", absl::StrJoin(parts, ", "), ". ");
}

std::string DescribeInput(const LoadedRecordings& loaded, const ReplayInput& input) {
  std::string note = input.closures_note;
  if (input.closures.empty()) note = "Robots report no measured loop closures. ";
  absl::StrAppend(&note, DescribeObservations(input));
  if (loaded.drift.has_value()) absl::StrAppend(&note, Describe(*loaded.drift), " ");
  for (const Recording& recording : loaded.recordings) {
    if (recording.note.empty()) continue;
    absl::StrAppend(&note, recording.name, ": ", recording.note, ". ");
  }
  return std::string(absl::StripAsciiWhitespace(note));
}

}  // namespace

absl::StatusOr<ReplayInput> MakeReplayInput(const ReplayOptions& options) {
  ReplayInput input;
  const absl::StatusOr<ClosureTolerance> tolerance =
      ParseClosureTolerance(options.closure_tolerance);
  if (!tolerance.ok()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--closure-tolerance: ", tolerance.status().message()));
  }
  input.closure_tolerance = *tolerance;
  ASSIGN_OR_RETURN(const LoadedRecordings loaded, LoadRecordings(options));
  ASSIGN_OR_RETURN(input.plans, MakePlans(options, loaded));
  AddRecorded(options, loaded.recordings, &input);
  if (!options.closures_file.empty()) RETURN_IF_ERROR(AddFromFile(options, &input));
  RETURN_IF_ERROR(AddSimulated(options, &input));
  input.closures_note = DescribeInput(loaded, input);
  return input;
}

std::vector<RobotRecording> MakeRecordings(const ReplayInput& input) {
  std::vector<RobotRecording> recordings;
  std::map<MissionId, int> robot_of;
  for (const RobotPlan& plan : input.plans) {
    robot_of[plan.id] = static_cast<int>(recordings.size());
    recordings.push_back({plan.id, plan.keyframes, {}, {}, plan.observations});
  }
  const auto finder = [&](const NodeId& from, const NodeId& to) -> RobotRecording& {
    const int from_robot = robot_of.at(from.mission);
    const int to_robot = robot_of.at(to.mission);
    const double from_time = input.plans[from_robot].TimeOf(static_cast<int>(from.index));
    const double to_time = input.plans[to_robot].TimeOf(static_cast<int>(to.index));
    return recordings[from_time > to_time ? from_robot : to_robot];
  };
  for (const InputClosure& input_closure : input.closures) {
    const LoopClosure& closure = input_closure.closure;
    finder(closure.from, closure.to).closures.push_back(closure);
  }
  for (const ScoredCandidate& candidate : input.candidates) {
    finder(candidate.from, candidate.to).candidates.push_back(candidate);
  }
  return recordings;
}

}  // namespace overtone
