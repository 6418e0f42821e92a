// SPDX-License-Identifier: Apache-2.0
// A robot behind a link that is cut, silent, slow, lossy or broken off in the middle of a message:
// all that it handed over arrives once, little is sent again, and the host knows how the link is.
// OVERTONE_TEST_LINK_REAL=1: cuts of 1 s and 60 s in real time, too.
#include <algorithm>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/strings/str_join.h"
#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "gtest/gtest.h"
#include "overtone/tests/fault/busy_robot.h"
#include "overtone/tests/fault/map_audit.h"
#include "overtone/tests/fault/server_under_fault.h"
#include "overtone/tests/support/fault_table.h"
#include "overtone/tests/support/faulty_link.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

constexpr int64_t kSubmaps = 40;
constexpr int64_t kWindowBytes = 1 << 20;  // the least that a server may have
constexpr absl::Duration kPatience = absl::Seconds(90);
// Design figures, in the time of the link.
constexpr absl::Duration kStaleWithin = absl::Seconds(20);
constexpr absl::Duration kFirstByteWithin = absl::Seconds(5);

const char* NameOf(LinkState state) {
  return state == LinkState::kLive ? "LIVE" : state == LinkState::kStale ? "STALE" : "CONNECTING";
}

// Until condition() holds; what nobody reports is asked for every millisecond.
template <typename Condition>
bool Await(const Condition& condition, absl::Duration timeout = kPatience) {
  const absl::Time deadline = absl::Now() + timeout;
  while (!condition()) {
    if (absl::Now() > deadline) return false;
    absl::Notification().WaitForNotificationWithTimeout(absl::Milliseconds(1));
  }
  return true;
}

// One robot, one link, one map. Durations of robot and server are divided by `scale`.
class Row {
 public:
  Row(std::string name, double scale = 1)
      : name_(std::move(name)),
        scale_(scale),
        server_(
            directory_.path(),
            absl::StrFormat("limits:\n  upload_window_bytes: %d\npublisher:\n  heartbeat_s: %g\n",
                            kWindowBytes, 5 / scale)) {
    const absl::Status started = server_.Start();
    if (!started.ok()) std::cerr << started << std::endl, std::abort();
    link_ = std::make_unique<FaultyLink>(server_.address());
  }

  void StartRobot(int points_per_cloud, absl::Duration interval = absl::Milliseconds(20)) {
    MappingClientOptions options;
    options.server = link_->address();
    options.map = "town";
    options.mission = {"robot_a", "run_1"};
    options.outbox_dir = directory_.File("outbox");
    options.initial_backoff /= scale_;
    options.max_backoff /= scale_;
    options.stale_after /= scale_;
    options.min_time_between_comparisons = absl::InfiniteDuration();
    BusyRobot::Pace pace;
    pace.interval = interval;
    pace.max_waiting = kSubmaps;
    pace.max_submaps = kSubmaps;
    pace.points_per_cloud = points_per_cloud;
    robot_ = std::make_unique<BusyRobot>(options, pace);
  }

  void AwaitAcknowledged(int64_t submaps) {
    EXPECT_TRUE(Await([&] { return acknowledged() >= submaps; })) << name_;
  }
  void AwaitState(LinkState state) {
    const absl::Time begin = absl::Now();
    EXPECT_TRUE(robot_->host().Await(
        [&] {
          robot_->host().mutex.AssertHeld();
          return !robot_->host().link_states.empty() && robot_->host().link_states.back() == state;
        },
        kPatience))
        << name_ << ": " << NameOf(state);
    const absl::Duration took = scale_ * (absl::Now() - begin);
    if (state != LinkState::kStale) return;
    told_stale_ = took;
    EXPECT_LE(took, kStaleWithin) << name_;
  }

  void Heal() {
    const int64_t before = acknowledged(), bytes_before = link_->bytes_up();
    const absl::Time begin = absl::Now();
    link_->Set({});
    EXPECT_TRUE(Await([&] { return link_->bytes_up() > bytes_before; })) << name_;
    first_byte_ = absl::Now() - begin;
    EXPECT_TRUE(Await([&] { return acknowledged() > before; })) << name_;
    first_ack_ = absl::Now() - begin;
    EXPECT_LE(first_byte_, kFirstByteWithin) << name_;
  }

  // Everything arrives; the row. `payload`: what a robot on a sound link sent for the same; 0: this
  // is the sound link.
  void Finish(int64_t payload) {
    EXPECT_TRUE(Await([&] { return robot_->handed() == kSubmaps; })) << name_;
    const absl::Status status = robot_->client().WaitUntilAcknowledged(kPatience);
    EXPECT_TRUE(status.ok()) << name_ << ": " << status;
    EXPECT_TRUE(robot_->Complaint().ok()) << name_ << ": " << robot_->Complaint();
    const MappingClientStats stats = robot_->client().Stats();
    bytes_sent_ = stats.bytes_sent;
    if (payload == 0) payload = bytes_sent_;
    const int64_t reconnects = link_->connections() - 1;
    const int64_t again = std::max<int64_t>(0, bytes_sent_ - payload);
    Print(again, payload, reconnects);
    // A header and a request to watch come with each connection, and the clock is asked for.
    EXPECT_LE(again, reconnects * (kWindowBytes + 1024) + 4096) << name_;
    Audit();
  }

  const std::string& name() const { return name_; }
  FaultyLink& link() { return *link_; }
  int64_t bytes_sent() const { return bytes_sent_; }
  int64_t acknowledged() const { return robot_->client().Stats().submaps_acknowledged; }
  int64_t handed() const { return robot_->handed(); }

 private:
  std::string States() const {
    absl::MutexLock lock(&robot_->host().mutex);
    std::vector<std::string> names;
    for (const LinkState state : robot_->host().link_states) names.push_back(NameOf(state));
    constexpr size_t kMostNames = 6;
    const size_t left_out = names.size() > kMostNames ? names.size() - kMostNames : 0;
    names.erase(names.begin(), names.begin() + left_out);
    return (left_out > 0 ? "... " : "") + absl::StrJoin(names, " ");
  }

  void Print(int64_t again, int64_t payload, int64_t reconnects) const {
    const auto seconds = [](absl::Duration duration) {
      return duration < absl::ZeroDuration()
                 ? std::string("-")
                 : absl::StrFormat("%.2f s", absl::ToDoubleSeconds(duration));
    };
    FaultRow("link", name_,
             absl::StrCat("reconnects ", reconnects, "; first byte ", seconds(first_byte_),
                          ", first acknowledgement ", seconds(first_ack_),
                          " after healing (real time); told STALE after ", seconds(told_stale_),
                          "; sent again ", again, " of ", payload, " bytes; host: ", States()));
  }

  void Audit() {
    const HandedOver handed_over = {{robot_->mission(), kSubmaps}};
    ASSERT_TRUE(AwaitMapped(server_.address(), "town", kSubmaps * kBusyKeyframes, kPatience).ok());
    const auto audit = AuditMap(server_.address(), "town", handed_over);
    ASSERT_TRUE(audit.ok()) << audit.status();
    EXPECT_EQ(audit->Sum(), 0) << name_ << ": " << ToString(*audit);
    robot_.reset();
    server_.Kill();
    EXPECT_EQ(SubmapsStoredTwice(server_.data_dir(), "town").value(), 0) << name_;
  }

  const std::string name_;
  const double scale_;
  const TemporaryDirectory directory_;
  ServerUnderFault server_;
  std::unique_ptr<FaultyLink> link_;
  std::unique_ptr<BusyRobot> robot_;
  int64_t bytes_sent_ = 0;
  absl::Duration first_byte_ = -absl::Seconds(1), first_ack_ = first_byte_;
  absl::Duration told_stale_ = first_byte_;
};

// What the same mission costs on a sound link.
int64_t Payload(int points_per_cloud) {
  Row row(absl::StrCat("sound, ", points_per_cloud, " points a cloud"));
  row.StartRobot(points_per_cloud);
  row.Finish(/*payload=*/0);
  return row.bytes_sent();
}

class LinkTest : public ::testing::Test {
 protected:
  static constexpr int kPoints = 8000, kFewPoints = 60;
  static int64_t payload() {
    static const int64_t bytes = Payload(kPoints);
    return bytes;
  }
  static int64_t small_payload() {
    static const int64_t bytes = Payload(kFewPoints);
    return bytes;
  }

  // The robot drives on while nothing goes through.
  void CutFor(const std::string& name, absl::Duration duration, double scale) {
    const int64_t expected = payload();
    Row row(name, scale);
    row.StartRobot(kPoints);
    row.AwaitAcknowledged(5);
    const absl::Time begin = absl::Now();
    LinkConditions conditions;
    conditions.refuse = true;
    row.link().Set(conditions);
    row.link().Cut();
    if (duration > absl::Seconds(20)) row.AwaitState(LinkState::kStale);
    ASSERT_TRUE(Await([&] { return row.handed() == kSubmaps; }));
    Await([] { return false; }, begin + duration / scale - absl::Now());
    row.Heal();
    row.AwaitState(LinkState::kLive);
    row.Finish(expected);
  }
};

TEST_F(LinkTest, ACutIsFilledIn) {
  CutFor("cut of 1 s, real time", absl::Seconds(1), 1);
  CutFor("cut of 60 s, time scaled 1:20", absl::Seconds(60), 20);
  CutFor("cut of 10 min, time scaled 1:100", absl::Minutes(10), 100);
}

TEST_F(LinkTest, ACutOfAMinuteInRealTimeIsFilledIn) {
  if (FromEnvironment("OVERTONE_TEST_LINK_REAL", 0) == 0)
    GTEST_SKIP() << "OVERTONE_TEST_LINK_REAL=1";
  CutFor("cut of 60 s, real time", absl::Seconds(60), 1);
}

// In real time: the figure is what the robot's operator waits for. Long enough for keepalive to
// give the connection up, too.
TEST_F(LinkTest, AHalfOpenLinkIsToldAndFilledIn) {
  const int64_t expected = payload();
  Row row("half-open for 30 s, real time");
  row.StartRobot(kPoints);
  row.AwaitAcknowledged(5);
  LinkConditions conditions;
  conditions.black_hole = true;
  const absl::Time begin = absl::Now();
  row.link().Set(conditions);
  row.AwaitState(LinkState::kStale);
  Await([] { return false; }, begin + absl::Seconds(30) - absl::Now());
  row.Heal();
  row.AwaitState(LinkState::kLive);
  row.Finish(expected);
}

TEST_F(LinkTest, ASlowRadioCarriesAll) {
  const int64_t expected = small_payload();
  Row row("64 kbit/s");
  LinkConditions conditions;
  conditions.bytes_per_second = 8000;
  row.link().Set(conditions);
  row.StartRobot(kFewPoints);
  row.Finish(expected);
}

TEST_F(LinkTest, ALongWayCarriesAll) {
  const int64_t expected = payload();
  Row row("500 ms each way");
  LinkConditions conditions;
  conditions.latency = absl::Milliseconds(500);
  row.link().Set(conditions);
  row.StartRobot(kPoints);
  row.Finish(expected);
}

TEST_F(LinkTest, ALossyLinkCarriesAll) {
  const int64_t expected = small_payload();
  Row row("30 % of segments lost");
  LinkConditions conditions;
  conditions.loss = 0.3;
  row.link().Set(conditions);
  row.StartRobot(kFewPoints);
  row.Finish(expected);
}

TEST_F(LinkTest, ConnectionsThatBreakInTheMiddleOfAMessageCarryAll) {
  const int64_t expected = payload();
  Row row("every connection reset after 200,011 bytes", /*scale=*/20);
  LinkConditions conditions;
  conditions.reset_after_bytes = 200'011;
  row.link().Set(conditions);
  row.StartRobot(kPoints);
  row.Finish(expected);
  EXPECT_GT(row.link().connections(), 3);
}

}  // namespace
}  // namespace overtone
