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
  std::optional<Rigid3d> common_from_world;
  double path_m = 0;  // of the whole odometry

  // What ties keyframes to the recording: its row of each keyframe, increasing, and all its poses
  // and frames.
  std::vector<int> rows;
  std::vector<Rigid3d> odometry;
  std::vector<int64_t> frames;

  // Data time of keyframe i since the first.
  double TimeOf(int i) const { return SecondsBetween(keyframes[0].stamp, keyframes[i].stamp); }
};

// InvalidArgument: the recording is empty or keeps fewer than two keyframes.
absl::StatusOr<RobotPlan> MakeRobotPlan(const Recording& recording,
                                        const KeyframeSelectionOptions& selection,
                                        const MotionNoise& noise);

// The measurement between frames of two recordings, carried by their odometry to the keyframes
// nearest to them. Absent: a robot lacks its frame, or both ends fall on one keyframe.
std::optional<LoopClosure> PlaceClosure(const FrameClosure& closure, const RobotPlan& from,
                                        const RobotPlan& to);

// All measurements between all robots of `plans` that hold both ends.
std::vector<LoopClosure> PlaceClosures(const std::vector<FrameClosure>& closures,
                                       const std::vector<RobotPlan>& plans);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_ROBOT_PLAN_H_
