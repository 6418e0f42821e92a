// SPDX-License-Identifier: Apache-2.0
// From a replay's options to what its robots play and which loop closures they find on the way.
#ifndef OVERTONE_CLIENT_CLI_REPLAY_INPUT_H_
#define OVERTONE_CLIENT_CLI_REPLAY_INPUT_H_

#include <string>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/client/cli/closure_judgement.h"
#include "overtone/client/cli/closure_simulation.h"
#include "overtone/client/cli/replay_options.h"
#include "overtone/client/cli/robot_plan.h"
#include "overtone/client/cli/robot_recording_file.h"

namespace overtone {

struct InputClosure {
  LoopClosure closure;
  bool simulated = false;
  bool outlier = false;
};

struct ReplayInput {
  std::vector<RobotPlan> plans;
  std::vector<InputClosure> closures;
  std::vector<ScoredCandidate> candidates;
  std::vector<LoopClosure> relations;  // known to be true, for evaluation only
  ClosureTolerance closure_tolerance;
  bool closures_simulated = false;  // some of them
  std::string closures_note;        // where they come from, and what else ties the map together
};

// Reads, cuts, aligns, simulates. Errors name the option or the file and line.
absl::StatusOr<ReplayInput> MakeReplayInput(const ReplayOptions& options);

// What each robot is to play. Robots find a closure or a candidate when the later of its ends, in
// data time since each robot's own start, is reached: it is in the recording of that robot.
std::vector<RobotRecording> MakeRecordings(const ReplayInput& input);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_REPLAY_INPUT_H_
