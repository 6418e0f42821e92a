// SPDX-License-Identifier: Apache-2.0
// What one robot will play: its recording cut down to keyframes.
#ifndef OVERTONE_CLIENT_CLI_ROBOT_PLAN_H_
#define OVERTONE_CLIENT_CLI_ROBOT_PLAN_H_

#include <optional>
#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/client/cli/dataset.h"
#include "overtone/client/cli/motion_noise.h"
#include "overtone/core/graph/node_selection.h"
#include "overtone/core/graph/submap.h"

namespace overtone {

// The ground truth has holes; within one longer than this nothing is interpolated.
inline constexpr double kMaxGroundTruthGap_s = 0.5;

struct RobotPlan {
  std::string name;
  MissionId id;
  std::vector<Keyframe> keyframes;
  std::vector<std::optional<Rigid3d>> ground_truth;  // of each keyframe: world_from_body
  bool ground_truth_positions_only = false;          // its rotations say nothing
  std::optional<Rigid3d> common_from_world;
  double path_m = 0;          // of the whole odometry
  Observations observations;  // of the keyframes

  // What ties keyframes to the recording: its row of each keyframe, increasing, and all its poses
  // and frames.
  std::vector<int> rows;
  std::vector<Rigid3d> odometry;
  std::vector<Timestamp> stamps;
  std::vector<int64_t> frames;

  // Data time of keyframe i since the first.
  double TimeOf(int i) const { return SecondsBetween(keyframes[0].stamp, keyframes[i].stamp); }
};

// Keyframes: those that `selection` keeps and recording.keyframes. A motion is degenerate when one
// of the frames on its way is. Observations between keyframes are left out.
// InvalidArgument: the recording is empty or keeps fewer than two keyframes.
absl::StatusOr<RobotPlan> MakeRobotPlan(const Recording& recording,
                                        const KeyframeSelectionOptions& selection,
                                        const MotionNoise& noise);

// The measurement from_tform_to between two rows of two recordings (or of one), carried by their
// odometry to the keyframes nearest to them. Absent when both ends fall on one keyframe.
std::optional<LoopClosure> PlaceClosure(const RobotPlan& from, int from_row, const RobotPlan& to,
                                        int to_row, const Rigid3d& from_tform_to,
                                        const Matrix6d& covariance);

// Every measurement, between all robots of `plans` that hold both its frames: where recordings
// overlap, each of them saw the place.
std::vector<LoopClosure> PlaceClosures(const std::vector<FrameClosure>& closures,
                                       const std::vector<RobotPlan>& plans);

// Every candidate, likewise, at the nearest keyframes: of those that fall on one pair the best
// score.
std::vector<ScoredCandidate> PlaceCandidates(const std::vector<FrameCandidate>& candidates,
                                             const std::vector<RobotPlan>& plans);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_ROBOT_PLAN_H_
