// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/watch_command.h"

#include <sys/ioctl.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>

#include "absl/strings/str_cat.h"
#include "absl/time/clock.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/cli/admin_flags.h"
#include "overtone/client/cli/interrupt.h"
#include "overtone/client/cli/server_error.h"
#include "overtone/client/cli/watch.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

constexpr char kClearScreen[] = "\x1b[H\x1b[J";

struct WatchFlags : AdminFlags {
  WatchFlags() {
    map = "";
    timeout_s = 5;
  }
  double interval_s = 1;
  int looks = 0;
};

// Of the terminal; 0: it does not say.
int TerminalRows() {
  winsize size = {};
  return ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 ? size.ws_row : 0;
}

class Watch {
 public:
  explicit Watch(const WatchFlags& flags)
      : flags_(flags),
        client_(flags.Client()),
        log_(flags.json),
        live_(isatty(STDOUT_FILENO) && !flags.json) {}

  // A server that goes away is waited for. Any other error of its ends this.
  absl::Status Look() {
    const absl::StatusOr<std::vector<WatchedMap>> maps = LookAt(client_, flags_.map);
    if (!maps.ok() && !MayComeBack(maps.status())) return maps.status();
    if (maps.ok()) last_ = *maps;
    if (live_) {
      Show(maps.status());
    } else {
      const absl::Time now = absl::Now();
      std::cout << (maps.ok() ? log_.Changes(*maps, now) : log_.Lost(maps.status(), now))
                << std::flush;
    }
    return std::cout ? absl::OkStatus() : absl::UnavailableError("standard output is closed");
  }

 private:
  void Show(const absl::Status& status) const {
    std::cout << kClearScreen << "overtone watch " << flags_.server << "   "
              << absl::FormatTime("%H:%M:%S UTC", absl::Now(), absl::UTCTimeZone())
              << "   Ctrl-C ends\n";
    if (!status.ok()) std::cout << "LOST, trying again: " << status.message() << "\n";
    const int rows = TerminalRows();
    std::cout << "\n" << Picture(last_, rows > 0 ? std::max(5, rows - 4) : 0) << std::flush;
  }

  const WatchFlags& flags_;
  AdminClient client_;
  ChangeLog log_;
  const bool live_;
  std::vector<WatchedMap> last_;
};

// False: Ctrl-C.
bool Pause(absl::Duration duration) {
  const absl::Time end = absl::Now() + duration;
  while (absl::Now() < end) {
    if (!CheckInterrupted().ok()) return false;
    absl::SleepFor(std::min(end - absl::Now(), absl::Milliseconds(50)));
  }
  return CheckInterrupted().ok();
}

absl::Status Run(const WatchFlags& flags) {
  CatchInterrupts();
  Watch watch(flags);
  for (int look = 1;; ++look) {
    RETURN_IF_ERROR(watch.Look());
    if (look == flags.looks || !Pause(absl::Seconds(flags.interval_s))) return absl::OkStatus();
  }
}

}  // namespace

void AddWatchCommand(CLI::App* app, std::function<int()>* run) {
  const auto flags = std::make_shared<WatchFlags>();
  CLI::App* command = AddAdminCommand(
      app, "watch", "Show maps and robots live", {/*map=*/true, /*json=*/true}, flags.get(),
      [flags] { return Run(*flags); }, run);
  command->get_option("--map")->description("Only this map [all]");
  command->add_option("--interval", flags->interval_s, "Seconds between looks")
      ->check(CLI::Range(0.1, 3600.0))
      ->capture_default_str();
  command->add_option("--looks", flags->looks, "End after so many, 0: with Ctrl-C")
      ->check(CLI::NonNegativeNumber)
      ->capture_default_str();
  command->footer(
      "On a terminal a picture that is drawn anew; else, and with --json, a line for each map and "
      "robot that\n"
      "has changed. A server that goes away is waited for. Ends with Ctrl-C, exit code 0.\n"
      "--json: {\"time\", \"map\", \"summary\": MapSummary}, {\"time\", \"map\", \"robot\": Robot} "
      "or "
      "{\"time\", \"error\"},\n"
      "which is empty when the server is back.\n\n"
      "  overtone watch --map town\n"
      "  overtone watch --json | jq -r 'select(.robot).robot.report.link.bytes_waiting'");
}

}  // namespace overtone
