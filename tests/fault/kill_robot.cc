// SPDX-License-Identifier: Apache-2.0
// The robot's process of robot_kill_test: hands over the numbered submaps of one mission as fast as
// they persist, and says on standard output what did.
//   kill_robot OUTBOX_DIR SERVER run|drain
// Lines: "next <sequence>" at the start, "handing <sequence>", "persisted <sequence>".
#include <unistd.h>

#include <cstdio>
#include <cstring>
#include <string>

#include "absl/strings/str_cat.h"
#include "overtone/client/mapping_client.h"
#include "overtone/tests/support/fake_host.h"
#include "overtone/tests/support/kill_robot_mission.h"

namespace overtone {
namespace {

constexpr absl::Duration kPatience = absl::Seconds(60);
// For what many processes have left.
constexpr absl::Duration kPatienceInTheEnd = absl::Minutes(14);

// One write each: a line is there as a whole or not at all.
void Say(const char* what, int64_t sequence) {
  const std::string line = absl::StrCat(what, " ", sequence, "\n");
  if (write(STDOUT_FILENO, line.data(), line.size()) < 0) _exit(3);
}

int Fail(const absl::Status& status) {
  std::fprintf(stderr, "kill_robot: %s\n", status.ToString().c_str());
  return 1;
}

// Bursts of one to eight submaps: transactions of many sizes.
int Run(MappingClient& client) {
  for (int64_t sequence = client.NextSubmap().sequence;; ++sequence) {
    Say("handing", sequence);  // before: it may persist, and we die before we can say so
    const absl::Status added = client.AddSubmap(KillRobotSubmap(sequence));
    if (!added.ok()) return Fail(added);
    if (sequence * 2654435761 % 8 != 0) continue;
    const absl::Status persisted = client.WaitUntilPersisted(kPatience);
    if (!persisted.ok()) return Fail(persisted);
    if (client.Stats().persisted_through < sequence) return Fail(absl::InternalError("not told"));
    Say("persisted", sequence);
  }
}

int Main(char** arguments) {
  FakeHost host;
  MappingClientOptions options;
  options.outbox_dir = arguments[1];
  options.server = arguments[2];
  options.map = "town";
  options.mission = TestMission();
  options.initial_backoff = absl::Milliseconds(2);
  options.max_backoff = absl::Milliseconds(50);
  options.outbox_sync_interval = absl::Milliseconds(20);
  options.log = [](LogLevel level, absl::string_view line) {
    if (level == LogLevel::kError) std::fprintf(stderr, "%s\n", std::string(line).c_str());
  };
  const auto client = MappingClient::Create(options, &host);
  if (!client.ok()) return Fail(client.status());
  Say("next", (*client)->NextSubmap().sequence);
  if (std::strcmp(arguments[3], "run") == 0) return Run(**client);
  const absl::Status status = (*client)->WaitUntilAcknowledged(kPatienceInTheEnd);
  return status.ok() ? 0 : Fail(status);
}

}  // namespace
}  // namespace overtone

int main(int argc, char** argv) { return argc == 4 ? overtone::Main(argv) : 2; }
