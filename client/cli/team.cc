// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/team.h"

#include <utility>

#include "absl/memory/memory.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

// A robot answers within its own timeout; this much later it is taken for dead.
constexpr absl::Duration kGrace = absl::Seconds(30);
// A step waits twice at most: for acknowledgements, or for the graph and the comparison.
constexpr int kWaitsPerStep = 2;

}  // namespace

Team::Team(std::function<absl::Status()> interrupted, absl::Duration timeout)
    : interrupted_(std::move(interrupted)), timeout_(timeout) {}

absl::StatusOr<std::unique_ptr<Team>> Team::Start(const TeamOptions& options,
                                                  const std::vector<TeamMember>& members,
                                                  std::function<absl::Status()> interrupted) {
  auto team =
      absl::WrapUnique(new Team(std::move(interrupted), kWaitsPerStep * options.timeout + kGrace));
  for (const TeamMember& member : members) {
    ChildProcessOptions child;
    child.name = absl::StrCat("robot ", member.name);
    child.arguments = {options.program,
                       "robot",
                       absl::StrCat("--recording=", member.recording),
                       absl::StrCat("--server=", options.server),
                       absl::StrCat("--map=", options.map),
                       absl::StrCat("--timeout=", absl::ToDoubleSeconds(options.timeout))};
    child.arguments.insert(child.arguments.end(), member.client_arguments.begin(),
                           member.client_arguments.end());
    ASSIGN_OR_RETURN(std::unique_ptr<ChildProcess> robot, ChildProcess::Start(std::move(child)));
    team->robots_.push_back(std::move(robot));
  }
  return team;
}

absl::StatusOr<std::vector<Json>> Team::AskAll(const std::string& line) {
  for (const auto& robot : robots_) RETURN_IF_ERROR(robot->WriteLine(line));
  std::vector<Json> answers;
  for (const auto& robot : robots_) {
    ASSIGN_OR_RETURN(Json answer, Answer(robot.get()));
    answers.push_back(std::move(answer));
  }
  return answers;
}

absl::StatusOr<Json> Team::Answer(ChildProcess* robot) {
  ASSIGN_OR_RETURN(const std::string line, robot->ReadLine(timeout_, interrupted_));
  Json answer;
  RETURN_IF_ERROR(Decode(line, robot->name(), [&answer](const Json& json) { answer = json; }));
  if (answer.contains("error")) {
    return absl::UnavailableError(
        absl::StrCat(robot->name(), ": ", answer.at("error").get<std::string>()));
  }
  return answer;
}

}  // namespace overtone
