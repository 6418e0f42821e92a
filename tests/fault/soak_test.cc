// SPDX-License-Identifier: Apache-2.0
// Eight robots for OVERTONE_TEST_SOAK_S seconds, one mission after the other: what the server's
// process and that of the robots (this one) hold stays what it was after the warm-up, but for the
// map that grows. Prints a row of figures now and then (CSV), and a verdict.
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "absl/synchronization/notification.h"
#include "absl/time/clock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/tests/fault/busy_robot.h"
#include "overtone/tests/fault/process_usage.h"
#include "overtone/tests/fault/server_under_fault.h"
#include "overtone/tests/support/fault_table.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

constexpr char kMap[] = "town";
constexpr int kRobots = 8, kSamples = 60;
// Submaps a second and robot: some twenty times what a robot that walks hands over.
constexpr absl::Duration kInterval = absl::Milliseconds(500);
constexpr int64_t kSubmapsPerMission = 120;
constexpr absl::Duration kPatience = absl::Seconds(120);
// Verdict. A keyframe costs the map its pose, edges, and place in the log's index.
constexpr double kMaxServerBytesPerKeyframe = 16e3;
constexpr double kMaxClientMegabytesPerHour = 16;
// Before, caches still fill: slopes are printed, and judge nothing.
constexpr int64_t kLongEnough_s = 1800;
constexpr int64_t kMaxMoreThreads = 16, kMaxMoreDescriptors = 32;

struct Sample {
  double seconds = 0;
  double keyframes = 0;
  ProcessUsage server, client;
};

// Least squares: dy/dx.
template <typename X, typename Y>
double Slope(const std::vector<Sample>& samples, const X& x, const Y& y) {
  double mean_x = 0, mean_y = 0, xx = 0, xy = 0;
  for (const Sample& sample : samples) {
    mean_x += x(sample) / samples.size();
    mean_y += y(sample) / samples.size();
  }
  for (const Sample& sample : samples) {
    xx += (x(sample) - mean_x) * (x(sample) - mean_x);
    xy += (x(sample) - mean_x) * (y(sample) - mean_y);
  }
  return xx > 0 ? xy / xx : 0;
}

class SoakTest : public ::testing::Test {
 protected:
  void SetUp() override {
    seconds_ = FromEnvironment("OVERTONE_TEST_SOAK_S", 0);
    if (seconds_ == 0) GTEST_SKIP() << "OVERTONE_TEST_SOAK_S=3600 for an hour";
    ASSERT_TRUE(server_.Start().ok());
    robots_.resize(kRobots);
    runs_.resize(kRobots);
    for (int i = 0; i < kRobots; ++i) NextMission(i);
  }

  void NextMission(int i) {
    if (robots_[i] != nullptr) {
      const absl::Status status = robots_[i]->client().WaitUntilAcknowledged(kPatience);
      EXPECT_TRUE(status.ok()) << status;
      EXPECT_TRUE(robots_[i]->Complaint().ok()) << robots_[i]->Complaint();
      robots_[i].reset();
    }
    MappingClientOptions options;
    options.server = server_.address();
    options.map = kMap;
    options.mission = {absl::StrCat("robot_", i), absl::StrCat("run_", ++runs_[i])};
    options.outbox_dir = directory_.File(options.mission.robot);
    BusyRobot::Pace pace;
    pace.interval = kInterval;
    pace.max_submaps = kSubmapsPerMission;
    robots_[i] = std::make_unique<BusyRobot>(options, pace);
  }

  Sample Measure(double seconds) {
    Sample sample;
    sample.seconds = seconds;
    const auto map = AdminClient(server_.address(), kPatience).GetMap(kMap);
    EXPECT_TRUE(map.ok()) << map.status();
    if (map.ok()) sample.keyframes = static_cast<double>(map->keyframes());
    sample.server = UsageOf(server_.pid());
    sample.client = UsageOf(getpid());
    std::cout << absl::StrFormat("%.0f,%.0f,%d,%d,%d,%d,%d,%d", seconds, sample.keyframes,
                                 sample.server.resident_kb, sample.server.file_descriptors,
                                 sample.server.threads, sample.client.resident_kb,
                                 sample.client.file_descriptors, sample.client.threads)
              << std::endl;
    return sample;
  }

  int64_t seconds_ = 0;
  const TemporaryDirectory directory_;
  ServerUnderFault server_{directory_.path(), "log_level: warning\n"};
  std::vector<std::unique_ptr<BusyRobot>> robots_;
  std::vector<int> runs_;
};

// By how much the most of the later half exceeds the most of the earlier one.
template <typename Value>
int64_t Growth(const std::vector<Sample>& samples, const Value& value) {
  int64_t early = 0, late = 0;
  for (size_t i = 0; i < samples.size(); ++i) {
    int64_t& most = i < samples.size() / 2 ? early : late;
    most = std::max<int64_t>(most, value(samples[i]));
  }
  return late - early;
}

TEST_F(SoakTest, NothingGrowsButTheMap) {
  std::cout << "seconds,keyframes,server_kb,server_fds,server_threads,robots_kb,robots_fds,"
               "robots_threads"
            << std::endl;
  const absl::Time begin = absl::Now();
  std::vector<Sample> samples;  // after the warm-up
  for (int k = 1; k <= kSamples; ++k) {
    const absl::Time due = begin + absl::Seconds(seconds_) * k / kSamples;
    absl::Notification().WaitForNotificationWithTimeout(due - absl::Now());
    for (int i = 0; i < kRobots; ++i) {
      if (robots_[i]->handed() == kSubmapsPerMission) NextMission(i);
    }
    const Sample sample = Measure(absl::ToDoubleSeconds(absl::Now() - begin));
    if (k > kSamples / 4) samples.push_back(sample);
  }
  const double server_bytes_per_keyframe =
      1024 * Slope(
                 samples, [](const Sample& s) { return s.keyframes; },
                 [](const Sample& s) { return s.server.resident_kb; });
  const double client_mb_per_hour = 3600.0 / 1024 *
                                    Slope(
                                        samples, [](const Sample& s) { return s.seconds; },
                                        [](const Sample& s) { return s.client.resident_kb; });
  const int64_t more_descriptors =
      std::max(Growth(samples, [](const Sample& s) { return s.server.file_descriptors; }),
               Growth(samples, [](const Sample& s) { return s.client.file_descriptors; }));
  const int64_t more_threads =
      std::max(Growth(samples, [](const Sample& s) { return s.server.threads; }),
               Growth(samples, [](const Sample& s) { return s.client.threads; }));
  FaultRow(
      "soak", absl::StrCat(kRobots, " robots, ", seconds_, " s"),
      absl::StrFormat("%.0f keyframes; server %+.0f bytes a keyframe, robots %+.1f MB an hour; "
                      "descriptors %+d, threads %+d; at the end server %d MB, robots %d MB",
                      samples.back().keyframes, server_bytes_per_keyframe, client_mb_per_hour,
                      more_descriptors, more_threads, samples.back().server.resident_kb / 1024,
                      samples.back().client.resident_kb / 1024));
  EXPECT_LE(more_descriptors, kMaxMoreDescriptors);
  EXPECT_LE(more_threads, kMaxMoreThreads);
  if (seconds_ < kLongEnough_s) return;
  EXPECT_LT(server_bytes_per_keyframe, kMaxServerBytesPerKeyframe);
  EXPECT_LT(client_mb_per_hour, kMaxClientMegabytesPerHour);
}

}  // namespace
}  // namespace overtone
