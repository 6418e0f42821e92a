// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/robot_command.h"

#include <iostream>
#include <memory>
#include <string>
#include <utility>

#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_split.h"
#include "overtone/client/cli/client_flags.h"
#include "overtone/client/cli/robot_player.h"
#include "overtone/client/cli/tls_flags.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

struct RobotFlags {
  std::string recording;
  std::string server = "localhost:7077";
  std::string map = "default";
  double timeout_s = 300;
  TlsFiles tls;
  ClientFlags client;
};

void LogToStderr(LogLevel level, absl::string_view message) {
  if (level == LogLevel::kInfo) return;
  std::cerr << absl::StrCat(level == LogLevel::kError ? "error: " : "warning: ", message, "\n");
}

absl::StatusOr<Json> Answer(const std::string& line, RobotPlayer* player) {
  const std::pair<std::string, std::string> words = absl::StrSplit(line, absl::MaxSplits(' ', 1));
  double time_s = 0;
  uint64_t revision = 0;
  if (words.first == "advance" && absl::SimpleAtod(words.second, &time_s)) {
    return player->Advance(time_s);
  }
  if (words.first == "compare" && absl::SimpleAtoi(words.second, &revision)) {
    return player->Compare(revision);
  }
  return absl::InvalidArgumentError(
      absl::StrCat("\"", line, "\": expected \"advance SECONDS\" or \"compare REVISION\""));
}

absl::StatusOr<std::unique_ptr<RobotPlayer>> MakePlayer(const RobotFlags& flags) {
  RETURN_IF_ERROR(CheckTlsFlags(flags.tls, flags.server));
  ASSIGN_OR_RETURN(RobotRecording recording, ReadRobotRecording(flags.recording));
  MappingClientOptions options;
  options.server = flags.server;
  options.tls = flags.tls;
  options.map = flags.map;
  options.log = LogToStderr;
  flags.client.ApplyTo(&options);
  return RobotPlayer::Create(std::move(recording), std::move(options),
                             absl::Seconds(flags.timeout_s));
}

int Run(const RobotFlags& flags) {
  absl::StatusOr<std::unique_ptr<RobotPlayer>> player = MakePlayer(flags);
  absl::Status status = player.status();
  std::string line;
  while (status.ok() && std::getline(std::cin, line)) {
    const absl::StatusOr<Json> answer = Answer(line, player->get());
    status = answer.status();
    if (status.ok()) std::cout << answer->dump() << std::endl;
  }
  if (status.ok()) return 0;
  std::cout << Json{{"error", std::string(status.message())}}.dump() << std::endl;
  return 1;
}

}  // namespace

void AddRobotCommand(CLI::App* app, std::function<int()>* run) {
  auto flags = std::make_shared<RobotFlags>();
  CLI::App* command = app->add_subcommand("robot", "Play one robot's recording, step by step");
  command->footer(
      "Reads lines from standard input and answers each with one line of JSON:\n"
      "  advance SECONDS   play the keyframes up to this data time, upload them, and wait until "
      "they are\n"
      "                    acknowledged\n"
      "  compare REVISION  wait for a graph of at least this revision that holds the newest "
      "keyframe,\n"
      "                    compare it with the onboard estimate and apply the constraints\n"
      "After an error it answers {\"error\": ...} and ends with code 1. `overtone replay` writes "
      "recordings\n"
      "and drives a team of these; with none of your own, look at recording.json in its output.\n\n"
      "  echo advance 60 | overtone robot --recording run/anna/recording.json --map town");
  command->add_option("--recording", flags->recording, "JSON file of keyframes and loop closures")
      ->required()
      ->check(CLI::ExistingFile);
  command->add_option("--server", flags->server, "host:port of the mapping server")
      ->capture_default_str();
  command->add_option("--map", flags->map, "Map to join")->capture_default_str();
  command->add_option("--timeout", flags->timeout_s, "Seconds to wait for the server in each step")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  AddTlsFlags(command, &flags->tls);
  AddClientFlags(command, &flags->client);
  command->callback([flags, run] { *run = [flags] { return Run(*flags); }; });
}

}  // namespace overtone
