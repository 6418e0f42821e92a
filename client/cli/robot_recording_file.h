// SPDX-License-Identifier: Apache-2.0
// The file that one robot plays: {"robot", "mission", "keyframes": [...], "loop_closures": [...],
// "candidates": [...], "observations": {...}}; the last two may be left out.
#ifndef OVERTONE_CLIENT_CLI_ROBOT_RECORDING_FILE_H_
#define OVERTONE_CLIENT_CLI_ROBOT_RECORDING_FILE_H_

#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/client/cli/observations.h"
#include "overtone/core/graph/submap.h"

namespace overtone {

struct RobotRecording {
  MissionId id;
  std::vector<Keyframe> keyframes;
  // Each belongs to the last of its two ends that the team has seen; that end is in this mission.
  std::vector<LoopClosure> closures;
  std::vector<ScoredCandidate> candidates;  // likewise
  Observations observations;                // clouds in files
};

absl::Status WriteRobotRecording(const std::string& path, const RobotRecording& recording);

// NotFound; InvalidArgument naming the file and what is wrong.
absl::StatusOr<RobotRecording> ReadRobotRecording(const std::string& path);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_ROBOT_RECORDING_FILE_H_
