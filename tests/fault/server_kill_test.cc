// SPDX-License-Identifier: Apache-2.0
// kill -9 of the server at random moments and at every failpoint, with four robots uploading and a
// watcher: what was acknowledged is there after the restart, everything handed over in the end,
// once and as sent. OVERTONE_TEST_KILLS: how many (default 100); OVERTONE_TEST_SEED.
#include <algorithm>
#include <iostream>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/time/clock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/tests/fault/busy_robot.h"
#include "overtone/tests/fault/map_audit.h"
#include "overtone/tests/fault/revision_watcher.h"
#include "overtone/tests/fault/server_under_fault.h"
#include "overtone/tests/support/fault_table.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

constexpr char kMap[] = "town";
constexpr int kRobots = 4;
// A new map and a new data directory after so many: what is measured is not a map that grows.
constexpr int64_t kKillsPerMap = 50;
constexpr absl::Duration kFailpointPatience = absl::Seconds(5);
constexpr absl::Duration kDrainTimeout = absl::Seconds(120);

struct Failpoint {
  const char* name;
  int max_count;  // of passes before the kill
};
constexpr Failpoint kFailpoints[] = {
    {"store_before_write", 12},  {"store_after_write", 12}, {"store_before_commit", 12},
    {"store_after_commit", 12},  {"store_before_ack", 12},  {"snapshot_before_write", 2},
    {"snapshot_after_write", 2},
};
constexpr int kNumFailpoints = sizeof(kFailpoints) / sizeof(kFailpoints[0]);

struct Figures {
  int64_t kills = 0, at_failpoints = 0, at_random = 0, while_starting = 0;
  int64_t restarts_checked = 0;
  int64_t acknowledged_lost = 0;
  int64_t epochs_changed = 0;
  int64_t revisions_back = 0;
  int64_t stored_twice = 0;
  int64_t submaps = 0, clouds = 0;
  int64_t watched = 0;
  MapAudit audit;
  std::vector<double> serving_ms;  // from the start of the process to its first graph
};

// One map, its robots, and a server that dies again and again.
class KillRound {
 public:
  KillRound(std::mt19937_64* random, Figures* figures)
      : random_(*random), figures_(*figures), server_(directory_.path()) {
    for (int i = 0; i < kRobots; ++i) {
      MappingClientOptions options;
      options.server = server_.address();
      options.map = kMap;
      options.mission = {absl::StrCat("robot_", i), "run_1"};
      options.outbox_dir = directory_.File(options.mission.robot);
      options.initial_backoff = absl::Milliseconds(5);
      options.max_backoff = absl::Milliseconds(40);
      options.min_time_between_comparisons = absl::InfiniteDuration();
      robots_.push_back(std::make_unique<BusyRobot>(options, BusyRobot::Pace()));
    }
    watcher_ = std::make_unique<RevisionWatcher>(server_.address(), kMap);
  }

  void Kill(int64_t number) {
    ++figures_.kills;
    switch (number % 4) {
      case 0:
        return KillWhileStarting();
      case 1:
        return KillAtRandom();
      default:
        return KillAtFailpoint(kFailpoints[number / 2 % kNumFailpoints]);
    }
  }

  // Everything that was handed over, once; and once more after another kill.
  void Finish() {
    HandedOver handed_over;
    int64_t keyframes = 0;
    ASSERT_TRUE(server_.Start().ok());
    for (const auto& robot : robots_) {
      robot->Rest();
      const absl::Status status = robot->client().WaitUntilAcknowledged(kDrainTimeout);
      EXPECT_TRUE(robot->Complaint().ok()) << robot->Complaint();
      ASSERT_TRUE(status.ok()) << ToString(robot->mission()) << ": " << status;
      handed_over[robot->mission()] = robot->handed();
      keyframes += robot->handed() * kBusyKeyframes;
      figures_.submaps += robot->handed();
    }
    CheckAll(handed_over, keyframes);
    server_.Kill();
    ASSERT_TRUE(server_.Start().ok());
    CheckAll(handed_over, keyframes);
    const RevisionWatcher::Books books = watcher_->books();
    figures_.revisions_back += books.went_back + books.wrong_deltas;
    figures_.epochs_changed += books.other_epochs;
    figures_.watched += books.graphs;
    EXPECT_GT(books.streams, 1);
    server_.Kill();
    const auto twice = SubmapsStoredTwice(server_.data_dir(), kMap);
    ASSERT_TRUE(twice.ok()) << twice.status();
    figures_.stored_twice += *twice;
  }

 private:
  void KillWhileStarting() {
    ++figures_.while_starting;
    ASSERT_TRUE(server_.Spawn().ok());
    server_.AwaitEnd(absl::Milliseconds(Uniform(0, 150)));
    server_.Kill();
  }

  void KillAtRandom() {
    ++figures_.at_random;
    StartAndCheck("");
    server_.AwaitEnd(absl::Microseconds(Uniform(0, 500'000)));
    server_.Kill();
  }

  void KillAtFailpoint(const Failpoint& point) {
    StartAndCheck(absl::StrCat(point.name, ":", Uniform(1, point.max_count)));
    const bool reached = server_.AwaitEnd(kFailpointPatience);
    ++(reached ? figures_.at_failpoints : figures_.at_random);
    server_.Kill();
  }

  int64_t Uniform(int64_t from, int64_t to) {
    return std::uniform_int_distribution<int64_t>(from, to)(random_);
  }

  // What the robots and the watcher know is asked for before what the server says now. The server
  // may die meanwhile, at its failpoint; what it has said until then counts.
  void StartAndCheck(const std::string& failpoint) {
    const RevisionWatcher::Books known = watcher_->books();
    std::vector<int64_t> acknowledged;
    for (const auto& robot : robots_) {
      acknowledged.push_back(robot->client().Stats().submaps_acknowledged);
    }
    const absl::Time begin = absl::Now();
    if (!server_.Start(failpoint).ok()) {
      ASSERT_FALSE(failpoint.empty());
      return;
    }
    if (*std::max_element(acknowledged.begin(), acknowledged.end()) == 0) return;
    for (int i = 0; i < kRobots; ++i) {
      const auto state = UploadStateOf(server_.address(), kMap, robots_[i]->mission());
      if (!state.ok()) return CheckThatItDied(state.status());
      figures_.acknowledged_lost += std::max<int64_t>(0, acknowledged[i] - state->next_sequence());
      EXPECT_EQ(state->next_index(), state->next_sequence() * kBusyKeyframes);
    }
    const auto map = AdminClient(server_.address(), absl::Seconds(20)).GetMap(kMap);
    if (!map.ok()) return CheckThatItDied(map.status());
    ++figures_.restarts_checked;
    figures_.serving_ms.push_back(absl::ToDoubleMilliseconds(absl::Now() - begin));
    figures_.revisions_back += map->revision() < known.revision;
    figures_.epochs_changed += known.map_epoch != 0 && map->map_epoch() != known.map_epoch;
  }

  void CheckThatItDied(const absl::Status& status) {
    EXPECT_TRUE(server_.AwaitEnd(absl::Seconds(5))) << status;
  }

  void CheckAll(const HandedOver& handed_over, int64_t keyframes) {
    const absl::Status mapped = AwaitMapped(server_.address(), kMap, keyframes, kDrainTimeout);
    EXPECT_TRUE(mapped.ok()) << mapped;
    const auto audit = AuditMap(server_.address(), kMap, handed_over);
    ASSERT_TRUE(audit.ok()) << audit.status();
    EXPECT_EQ(audit->Sum(), 0) << ToString(*audit);
    figures_.audit.Add(*audit);
  }

  std::mt19937_64& random_;
  Figures& figures_;
  const TemporaryDirectory directory_;
  ServerUnderFault server_;
  std::vector<std::unique_ptr<BusyRobot>> robots_;
  std::unique_ptr<RevisionWatcher> watcher_;
};

void Print(Figures& figures) {
  const auto row = [](const std::string& what, const std::string& figure) {
    FaultRow("server kill", what, figure);
  };
  row("kills: at failpoints, at random, while starting",
      absl::StrCat(figures.kills, ": ", figures.at_failpoints, ", ", figures.at_random, ", ",
                   figures.while_starting));
  row("submaps handed over by 4 robots", absl::StrCat(figures.submaps));
  row("acknowledged submaps lost", absl::StrCat(figures.acknowledged_lost));
  row("stored twice", absl::StrCat(figures.stored_twice));
  row("in the end", ToString(figures.audit));
  row("map_epoch changed", absl::StrCat(figures.epochs_changed));
  row("revisions that went back, of " + absl::StrCat(figures.watched) + " graphs watched",
      absl::StrCat(figures.revisions_back));
  std::sort(figures.serving_ms.begin(), figures.serving_ms.end());
  if (figures.serving_ms.empty()) return;
  row("restart to serving, p50 and max of " + absl::StrCat(figures.restarts_checked),
      absl::StrFormat("%.0f ms, %.0f ms", figures.serving_ms[figures.serving_ms.size() / 2],
                      figures.serving_ms.back()));
}

TEST(ServerKill, WhatWasAcknowledgedIsThereAfterEveryKill) {
  const int64_t kills = FromEnvironment("OVERTONE_TEST_KILLS", 100);
  const int64_t seed = FromEnvironment("OVERTONE_TEST_SEED", 1);
  std::cout << "seed " << seed << std::endl;
  std::mt19937_64 random(seed);
  Figures figures;
  while (figures.kills < kills && !HasFatalFailure()) {
    KillRound round(&random, &figures);
    const int64_t end = std::min(kills, figures.kills + kKillsPerMap);
    while (figures.kills < end && !HasFatalFailure()) round.Kill(figures.kills);
    if (!HasFatalFailure()) round.Finish();
  }
  Print(figures);
  EXPECT_EQ(figures.acknowledged_lost, 0);
  EXPECT_EQ(figures.stored_twice, 0);
  EXPECT_EQ(figures.epochs_changed, 0);
  EXPECT_EQ(figures.revisions_back, 0);
  EXPECT_GT(figures.watched, 0);
  EXPECT_GT(figures.at_failpoints, kills / 4);
  EXPECT_GT(figures.submaps, kills);
}

}  // namespace
}  // namespace overtone
