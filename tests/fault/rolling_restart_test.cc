// SPDX-License-Identifier: Apache-2.0
// SIGTERM of a server that four robots upload to, and a new process in its place, five times: it
// says NOT_SERVING, ends in order within ten seconds, and nothing is lost.
// OVERTONE_TEST_RESTARTS: how many.
#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "absl/types/optional.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/tests/fault/busy_robot.h"
#include "overtone/tests/fault/map_audit.h"
#include "overtone/tests/fault/revision_watcher.h"
#include "overtone/tests/fault/server_under_fault.h"
#include "overtone/tests/support/fault_table.h"
#include "overtone/tests/support/health_watch.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

constexpr char kMap[] = "town";
constexpr int kRobots = 4;
constexpr int64_t kProgress = 20;  // submaps of each robot between two restarts
constexpr absl::Duration kPatience = absl::Seconds(60);
constexpr absl::Duration kDrainWithin = absl::Seconds(10);

class RollingRestartTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_TRUE(server_.Start().ok());
    for (int i = 0; i < kRobots; ++i) {
      MappingClientOptions options;
      options.server = server_.address();
      options.map = kMap;
      options.mission = {absl::StrCat("robot_", i), "run_1"};
      options.outbox_dir = directory_.File(options.mission.robot);
      options.min_time_between_comparisons = absl::InfiniteDuration();
      BusyRobot::Pace pace;
      pace.points_per_cloud = 3000;
      pace.interval = absl::Milliseconds(20);
      robots_.push_back(std::make_unique<BusyRobot>(options, pace));
    }
    watcher_ = std::make_unique<RevisionWatcher>(server_.address(), kMap);
  }

  std::vector<int64_t> Acknowledged() const {
    std::vector<int64_t> counts;
    for (const auto& robot : robots_) {
      counts.push_back(robot->client().Stats().submaps_acknowledged);
    }
    return counts;
  }

  // Until each robot has had so much more acknowledged: all are connected, and uploading.
  void AwaitProgress(int64_t submaps) {
    const std::vector<int64_t> before = Acknowledged();
    const absl::Time deadline = absl::Now() + kPatience;
    while (true) {
      const std::vector<int64_t> now = Acknowledged();
      int behind = 0;
      for (int i = 0; i < kRobots; ++i) behind += now[i] < before[i] + submaps;
      if (behind == 0) return;
      ASSERT_LT(absl::Now(), deadline) << behind << " robots do not come on";
      absl::Notification().WaitForNotificationWithTimeout(absl::Milliseconds(2));
    }
  }

  void Restart() {
    absl::optional<HealthWatch> health;
    health.emplace(server_.address(), "overtone.v1.MappingService");
    ASSERT_EQ(health->Next(kPatience), HealthWatch::Status::kServing);
    AwaitProgress(kProgress);
    const absl::Time begin = absl::Now();
    server_.Terminate();
    ASSERT_EQ(health->Next(kPatience), HealthWatch::Status::kNotServing);
    health.reset();  // its stream would be waited for as long as the server's deadline allows
    ASSERT_TRUE(server_.AwaitEnd(kPatience));
    drained_s_.push_back(absl::ToDoubleSeconds(absl::Now() - begin));
    EXPECT_TRUE(server_.Ending().ok()) << server_.Ending();
    const std::vector<int64_t> acknowledged = Acknowledged();
    const absl::Time start = absl::Now();
    ASSERT_TRUE(server_.Start().ok());
    for (int i = 0; i < kRobots; ++i) {
      const auto state = UploadStateOf(server_.address(), kMap, robots_[i]->mission());
      ASSERT_TRUE(state.ok()) << state.status();
      lost_ += std::max<int64_t>(0, acknowledged[i] - state->next_sequence());
    }
    AwaitProgress(1);
    back_s_.push_back(absl::ToDoubleSeconds(absl::Now() - start));
  }

  const TemporaryDirectory directory_;
  ServerUnderFault server_{directory_.path()};
  std::vector<std::unique_ptr<BusyRobot>> robots_;
  std::unique_ptr<RevisionWatcher> watcher_;
  std::vector<double> drained_s_, back_s_;
  int64_t lost_ = 0;
};

TEST_F(RollingRestartTest, LosesNothingUnderLoad) {
  const int64_t restarts = FromEnvironment("OVERTONE_TEST_RESTARTS", 5);
  for (int64_t i = 0; i < restarts && !HasFatalFailure(); ++i) Restart();
  ASSERT_FALSE(HasFatalFailure());

  HandedOver handed_over;
  int64_t submaps = 0, told_stale = 0;
  for (const auto& robot : robots_) {
    robot->Rest();
    const absl::Status status = robot->client().WaitUntilAcknowledged(kPatience);
    EXPECT_TRUE(status.ok()) << status;
    EXPECT_TRUE(robot->Complaint().ok()) << robot->Complaint();
    submaps += handed_over[robot->mission()] = robot->handed();
    absl::MutexLock lock(&robot->host().mutex);
    const auto& states = robot->host().link_states;
    told_stale += std::count(states.begin(), states.end(), LinkState::kStale);
  }
  const absl::Status mapped =
      AwaitMapped(server_.address(), kMap, submaps * kBusyKeyframes, kPatience);
  EXPECT_TRUE(mapped.ok()) << mapped;
  const auto audit = AuditMap(server_.address(), kMap, handed_over);
  ASSERT_TRUE(audit.ok()) << audit.status();
  const RevisionWatcher::Books books = watcher_->books();
  const double drained = *std::max_element(drained_s_.begin(), drained_s_.end());
  FaultRow("rolling restart", absl::StrCat(restarts, " under load of 4 robots"),
           absl::StrFormat("%d submaps, acknowledged and lost %d; %s; SIGTERM to the end at most "
                           "%.2f s; all robots go on %.2f s after the new start at most; told "
                           "STALE %d times; other epochs %d, revisions back %d",
                           submaps, lost_, ToString(*audit), drained,
                           *std::max_element(back_s_.begin(), back_s_.end()), told_stale,
                           books.other_epochs, books.went_back));
  EXPECT_EQ(lost_, 0);
  EXPECT_EQ(audit->Sum(), 0);
  EXPECT_EQ(books.other_epochs, 0);
  EXPECT_EQ(books.went_back, 0);
  EXPECT_EQ(books.wrong_deltas, 0);
  EXPECT_LE(drained, absl::ToDoubleSeconds(kDrainWithin));
}

}  // namespace
}  // namespace overtone
