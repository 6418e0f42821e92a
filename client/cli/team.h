// SPDX-License-Identifier: Apache-2.0
// The robots of a replay, each in a process of its own, marching in step in data time.
#ifndef OVERTONE_CLIENT_CLI_TEAM_H_
#define OVERTONE_CLIENT_CLI_TEAM_H_

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/time/time.h"
#include "overtone/client/cli/child_process.h"
#include "overtone/client/cli/json_codec.h"

namespace overtone {

struct TeamMember {
  std::string name;
  std::string recording;                      // file
  std::vector<std::string> client_arguments;  // ClientFlags::ToArguments
};

struct TeamOptions {
  std::string program;  // this program's path
  std::string server;   // host:port
  std::string map;
  absl::Duration timeout = absl::Seconds(300);  // for each robot, for each step
};

// Not thread-safe. Every error names its robot.
class Team {
 public:
  // One `overtone robot` for each member. `interrupted` is asked whenever the team waits.
  static absl::StatusOr<std::unique_ptr<Team>> Start(const TeamOptions& options,
                                                     const std::vector<TeamMember>& members,
                                                     std::function<absl::Status()> interrupted);

  int size() const { return static_cast<int>(robots_.size()); }

  // Tells all robots the same at once and collects their answers, in the order of the members.
  absl::StatusOr<std::vector<Json>> AskAll(const std::string& line);

 private:
  explicit Team(std::function<absl::Status()> interrupted, absl::Duration timeout);

  absl::StatusOr<Json> Answer(ChildProcess* robot);

  std::function<absl::Status()> interrupted_;
  absl::Duration timeout_;
  std::vector<std::unique_ptr<ChildProcess>> robots_;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_CLI_TEAM_H_
