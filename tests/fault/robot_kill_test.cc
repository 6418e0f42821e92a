// SPDX-License-Identifier: Apache-2.0
// kill -9 of the robot's process at random moments, with and without a server: what the client said
// had persisted reaches the server, once and in order. OVERTONE_TEST_KILLS: how many (default 60);
// OVERTONE_TEST_SEED.
#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <iostream>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "gtest/gtest.h"
#include "overtone/client/internal/cloud_encoding.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/tests/fault/submap_ledger.h"
#include "overtone/tests/support/fault_table.h"
#include "overtone/tests/support/kill_robot_mission.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

using Clock = std::chrono::steady_clock;
constexpr char kNowhere[] = "127.0.0.1:1";

// One process of the robot.
class RobotProcess {
 public:
  RobotProcess(const std::string& outbox_dir, const std::string& server, const std::string& mode) {
    int ends[2];
    if (pipe2(ends, O_CLOEXEC) != 0) std::abort();
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    std::string program = OVERTONE_KILL_ROBOT, dir = outbox_dir, address = server, how = mode;
    char* arguments[] = {program.data(), dir.data(), address.data(), how.data(), nullptr};
    if (posix_spawn(&pid_, program.c_str(), &actions, nullptr, arguments, environ) != 0) {
      std::abort();
    }
    posix_spawn_file_actions_destroy(&actions);
    close(ends[1]);
    output_ = ends[0];
  }
  ~RobotProcess() {
    if (pid_ > 0) Kill();
    close(output_);
  }

  // Reads until `deadline`, or until `enough`, or until the process ends.
  template <typename Enough>
  void ReadUntil(Clock::time_point deadline, const Enough& enough) {
    while (!enough()) {
      const auto left =
          std::chrono::duration_cast<std::chrono::microseconds>(deadline - Clock::now()).count();
      if (left <= 0) return;
      pollfd ready{output_, POLLIN, 0};
      const timespec timeout{left / 1'000'000, left % 1'000'000 * 1000};
      if (ppoll(&ready, 1, &timeout, nullptr) <= 0) return;
      if (!ReadSome()) return;
    }
  }

  void Kill() {
    kill(pid_, SIGKILL);
    Wait();
    while (ReadSome()) {
    }
  }

  // The exit status as waitpid gives it.
  int Wait() {
    int status = -1;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return status;
  }

  int64_t next = -1, handed = -1, persisted = -1;

 private:
  bool ReadSome() {
    char buffer[4096];
    const ssize_t count = read(output_, buffer, sizeof(buffer));
    if (count <= 0) return false;
    text_.append(buffer, count);
    for (size_t end; (end = text_.find('\n')) != std::string::npos; text_.erase(0, end + 1)) {
      std::istringstream line(text_.substr(0, end));
      std::string what;
      int64_t sequence = -1;
      line >> what >> sequence;
      (what == "next" ? next : what == "handing" ? handed : persisted) = sequence;
    }
    return true;
  }

  pid_t pid_ = -1;
  int output_ = -1;
  std::string text_;
};

std::string ExpectedSubmap(int64_t sequence) {
  const Submap submap = KillRobotSubmap(sequence);
  v1::Submap message = ToProto(submap);
  EXPECT_TRUE(AnnounceClouds(submap, message).ok());
  EXPECT_TRUE(EncodeClouds(submap.clouds, {}, message).failures.empty());
  return message.SerializeAsString();
}

TEST(RobotKill, WhatPersistedReachesTheServerOnceAndInOrder) {
  const int64_t kills = FromEnvironment("OVERTONE_TEST_KILLS", 60);
  const int64_t seed = FromEnvironment("OVERTONE_TEST_SEED", 1);
  std::cout << "seed " << seed << std::endl;
  std::mt19937_64 random(seed);
  std::uniform_int_distribution<int> after_us(0, 120'000);
  const TemporaryDirectory directory;
  SubmapLedger ledger;
  ScriptedMappingServer server(
      {[&](int, ScriptedMappingServer::Upload& upload) { return ledger.Serve(upload); }});

  int64_t persisted = -1, handed = -1, kills_at_start = 0, kills_without_server = 0;
  std::vector<double> restart_ms;
  for (int64_t i = 0; i < kills; ++i) {
    const bool server_away = random() % 2 == 0;
    const int64_t at_server = static_cast<int64_t>(ledger.books().submaps.size());
    const bool at_start = random() % 5 == 0;  // while the file is being opened
    const Clock::time_point begin = Clock::now();
    RobotProcess robot(directory.path(), server_away ? kNowhere : server.address(), "run");
    const auto started = [&] { return robot.next >= 0; };
    if (!at_start) {
      robot.ReadUntil(begin + std::chrono::seconds(60), started);
      ASSERT_TRUE(started()) << "kill " << i;
      restart_ms.push_back(std::chrono::duration<double, std::milli>(Clock::now() - begin).count());
    }
    robot.ReadUntil(Clock::now() + std::chrono::microseconds(after_us(random)),
                    [] { return false; });
    robot.Kill();
    kills_at_start += !started();
    kills_without_server += server_away;
    if (!started()) continue;
    ASSERT_GT(robot.next, persisted) << "kill " << i << ": what had persisted is wanted anew";
    ASSERT_LE(robot.next, handed + 1) << "kill " << i << ": knows what was never handed over";
    ASSERT_GE(robot.next, at_server) << "kill " << i << ": the server has what is forgotten here";
    handed = std::max(robot.next - 1, robot.handed);
    persisted = std::max(robot.next - 1, robot.persisted);
  }

  RobotProcess last(directory.path(), server.address(), "drain");
  last.ReadUntil(Clock::now() + std::chrono::seconds(900), [] { return false; });
  const int status = last.Wait();
  ASSERT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  ASSERT_GT(last.next, persisted);

  const SubmapLedger::Books books = ledger.books();
  const int64_t stored = static_cast<int64_t>(books.submaps.size());
  int64_t wrong = 0;
  for (int64_t i = 0; i < stored; ++i) wrong += books.submaps[i] != ExpectedSubmap(i);
  const int64_t lost = std::max<int64_t>(0, last.next - stored);
  std::sort(restart_ms.begin(), restart_ms.end());
  const auto row = [](const std::string& what, const std::string& figure) {
    FaultRow("robot kill", what, figure);
  };
  row("kills: while starting, without a server",
      absl::StrCat(kills, ": ", kills_at_start, ", ", kills_without_server));
  row("submaps persisted: at the server, lost", absl::StrCat(last.next, ": ", stored, ", ", lost));
  row("doubled; of other content; sent again, not stored",
      absl::StrCat(books.conflicts, "; ", wrong, "; ", books.sent_again));
  row("clouds at the server, lost",
      absl::StrCat(books.clouds, ", ", books.clouds_lacking + books.clouds_gone));
  row("start to NextSubmap, p50 and max",
      absl::StrFormat("%.0f ms, %.0f ms", restart_ms[restart_ms.size() / 2], restart_ms.back()));
  EXPECT_EQ(stored, last.next);
  EXPECT_EQ(books.conflicts, 0);
  EXPECT_EQ(books.gaps, 0);
  EXPECT_EQ(wrong, 0);
  EXPECT_EQ(books.clouds, 2 * stored);
  EXPECT_EQ(books.clouds_lacking, 0);
  EXPECT_EQ(books.clouds_gone, 0);
  EXPECT_GT(persisted, kills);
}

}  // namespace
}  // namespace overtone
