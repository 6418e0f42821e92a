// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/dataset.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "absl/strings/ascii.h"
#include "absl/strings/match.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "overtone/client/cli/g2o_recording.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/trajectory_io.h"

namespace overtone {
namespace {

constexpr int kShortestPart = 10;  // poses

TrajectoryFormat FormatOf(DatasetKind kind, absl::string_view path) {
  if (kind == DatasetKind::kMulran || kind == DatasetKind::kKitti) return TrajectoryFormat::kKitti;
  return absl::EndsWith(path, ".csv") ? TrajectoryFormat::kEuroc : TrajectoryFormat::kTum;
}

Recording* Find(std::vector<Recording>* recordings, absl::string_view name) {
  for (Recording& recording : *recordings) {
    if (recording.name == name) return &recording;
  }
  return nullptr;
}

}  // namespace

// Noise: of the order of what the evaluation sequences show (visual-inertial odometry for EuRoC,
// LiDAR odometry on the road for KITTI and MulRan, a hand-held camera for TUM).
DatasetDefaults DefaultsOf(DatasetKind kind) {
  switch (kind) {
    case DatasetKind::kExample:
    case DatasetKind::kEuroc:
    case DatasetKind::kTum:
      return {{0.4, 0.5}, {0.03, 0.002, 0.01}, true};
    case DatasetKind::kMulran:
    case DatasetKind::kKitti:
      return {{2, 0.3}, {0.1, 0.001, 0.01}, false};
    case DatasetKind::kG2o:
      return {{0, 0}, {}, false};  // every vertex; covariances are in the file
    // MRCLAM 6, and Radish intel (twice as bad) and aces (better): errors over 10 s of driving.
    case DatasetKind::kMrclam:
      return {{0.4, 0.5}, {0.07, 0.07, 0.11}, true};
    case DatasetKind::kPcd:
      return {{0, 0}, {0.03, 0.002, 0.01}, true};  // every scan
    case DatasetKind::kCarmen:
      return {{0.4, 0.3}, {0.07, 0.05, 0.06}, true};
    case DatasetKind::kTuc:
      return {{0.5, 0.5}, {}, true};  // covariances are in the file
  }
  return {};
}

absl::StatusOr<RobotSource> ParseRobotSource(absl::string_view text) {
  const std::vector<std::string> parts = absl::StrSplit(text, ':');
  if (parts.size() < 2 || parts.size() > 3 || parts[0].empty() || parts[1].empty()) {
    return absl::InvalidArgumentError(
        absl::StrCat("--robot \"", text, "\": expected NAME:odometry[:ground_truth]"));
  }
  return RobotSource{parts[0], parts[1], parts.size() == 3 ? parts[2] : ""};
}

absl::StatusOr<MissionId> MissionOf(absl::string_view name) {
  MissionId id = {absl::AsciiStrToLower(name), "run"};
  RETURN_IF_ERROR(ValidateId(id.robot, absl::StrCat("robot name \"", name, "\"")));
  return id;
}

absl::StatusOr<Recording> ReadRecording(DatasetKind kind, const RobotSource& source) {
  Recording recording;
  if (kind == DatasetKind::kG2o) {
    ASSIGN_OR_RETURN(recording, ReadG2oRecording(source.odometry_path));
  } else {
    ASSIGN_OR_RETURN(recording.odometry,
                     ReadTrajectory(source.odometry_path, FormatOf(kind, source.odometry_path)));
    recording.frames.resize(recording.odometry.size());
    std::iota(recording.frames.begin(), recording.frames.end(), 0);
  }
  recording.name = source.name;
  ASSIGN_OR_RETURN(recording.id, MissionOf(source.name));
  if (!source.ground_truth_path.empty()) {
    ASSIGN_OR_RETURN(
        recording.ground_truth,
        ReadTrajectory(source.ground_truth_path, FormatOf(kind, source.ground_truth_path)));
    if (DefaultsOf(kind).ground_truth_shared) recording.common_from_world = Rigid3d::Identity();
  }
  return recording;
}

absl::Status ApplyAlignments(const std::vector<std::string>& alignments,
                             std::vector<Recording>* recordings) {
  if (alignments.empty()) return absl::OkStatus();
  for (Recording& recording : *recordings) recording.common_from_world = Rigid3d::Identity();
  for (const std::string& alignment : alignments) {
    const std::pair<std::string, std::string> parts =
        absl::StrSplit(alignment, absl::MaxSplits(':', 1));
    Recording* recording = Find(recordings, parts.first);
    if (recording == nullptr || parts.second.empty()) {
      return absl::InvalidArgumentError(absl::StrCat(
          "--alignment \"", alignment, "\": expected NAME:file with NAME one of the robots"));
    }
    ASSIGN_OR_RETURN(const Rigid3d common_from_world, ReadAlignment(parts.second));
    recording->common_from_world = common_from_world;
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Recording>> SplitRecording(const Recording& recording, int parts,
                                                      double overlap) {
  if (parts < 2) return absl::InvalidArgumentError("--split: at least 2");
  if (!(overlap >= 0 && overlap <= 0.9)) {
    return absl::InvalidArgumentError("--overlap: must be in [0, 0.9]");
  }
  const int total = static_cast<int>(recording.odometry.size());
  const double length = total / (parts - (parts - 1) * overlap);
  if (length < kShortestPart) {
    return absl::InvalidArgumentError(
        absl::StrCat(recording.name, ": too short for --split ", parts));
  }
  std::vector<Recording> result;
  for (int part = 0; part < parts; ++part) {
    const double start = part * length * (1 - overlap);
    const int begin = static_cast<int>(std::lround(start));
    const int end =
        part + 1 == parts ? total : std::min(total, static_cast<int>(std::lround(start + length)));
    Recording cut;
    cut.name = absl::StrCat(recording.name, "_", part);
    ASSIGN_OR_RETURN(cut.id, MissionOf(cut.name));
    const Rigid3d start_from_mission = recording.odometry[begin].pose.Inverse();
    for (int i = begin; i < end; ++i) {
      cut.odometry.push_back(
          {recording.odometry[i].stamp, start_from_mission * recording.odometry[i].pose});
      cut.frames.push_back(recording.frames[i]);
      if (!recording.motion_covariances.empty()) {
        cut.motion_covariances.push_back(recording.motion_covariances[i]);
      }
    }
    cut.ground_truth = recording.ground_truth;
    cut.ground_truth_positions_only = recording.ground_truth_positions_only;
    if (!cut.ground_truth.empty()) cut.common_from_world = Rigid3d::Identity();
    // By frame: each part takes those that it holds.
    cut.closures = recording.closures;
    cut.candidates = recording.candidates;
    cut.observations = recording.observations;
    cut.keyframes = recording.keyframes;
    cut.degenerate = recording.degenerate;
    cut.relations = recording.relations;
    result.push_back(std::move(cut));
  }
  return result;
}

}  // namespace overtone
