// SPDX-License-Identifier: Apache-2.0
// Gathers what the robots and the server say during a replay into its result.
#ifndef OVERTONE_CLIENT_CLI_REPLAY_RECORD_H_
#define OVERTONE_CLIENT_CLI_REPLAY_RECORD_H_

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/json_codec.h"
#include "overtone/client/cli/replay_input.h"
#include "overtone/client/cli/run_result.h"

namespace overtone {

class ReplayRecord {
 public:
  // `input` must outlive the record.
  explicit ReplayRecord(const ReplayInput& input);

  // Data time of the longest recording.
  double duration_s() const { return duration_s_; }

  // One round of answers to "compare", one for each robot.
  absl::Status Add(const std::vector<Json>& answers);

  // "  40 s of 182 s, revision 12: +12 constraints; corrected 0.021 0.034 0.040 m"
  std::string ProgressLine(double time_s, uint64_t revision) const;

  // Fetches the optimised trajectories and the closures' verdicts, and evaluates. May be repeated
  // after an error.
  absl::StatusOr<RunResult> Finish(AdminClient* admin, const std::string& map);

 private:
  absl::Status AddAnswer(const Json& answer, const RobotPlan& plan, RobotResult* robot);
  absl::Status FetchTrajectory(AdminClient* admin, const std::string& map, const RobotPlan& plan,
                               RobotResult* robot);
  absl::Status FetchClosures(AdminClient* admin, const std::string& map);

  const ReplayInput& input_;
  double duration_s_ = 0;
  RunResult result_;
  std::vector<std::map<std::string, Constraint>> known_constraints_;  // of each robot, by id
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_REPLAY_RECORD_H_
