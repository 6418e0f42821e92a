// SPDX-License-Identifier: Apache-2.0
// What an operator sees of a robot that uploads, watches and compares; and how a robot's and an
// operator's error is found again in the server's log.
#include <chrono>
#include <memory>
#include <sstream>
#include <string>
#include <thread>

#include "absl/synchronization/mutex.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/client/estimator/onboard_estimator.h"
#include "overtone/client/mapping_client.h"
#include "overtone/services/mapping_server/log_format.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"
#include "spdlog/sinks/ostream_sink.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

const MissionId kAnna = {"anna", "run1"};
constexpr int kKeyframes = 60;
constexpr absl::Duration kPatience = absl::Seconds(30);

class RobotStatusTest : public testing::ServerTest {
 protected:
  void SetUp() override {
    before_ = spdlog::default_logger();
    auto sink = std::make_shared<spdlog::sinks::ostream_sink_mt>(log_);
    auto logger = std::make_shared<spdlog::logger>("captured", std::move(sink));
    logger->set_formatter(TextLines());
    spdlog::set_default_logger(std::move(logger));
    StartServer();
  }
  void TearDown() override {
    client_.reset();
    server_.reset();
    spdlog::set_default_logger(before_);
  }

  MappingClientOptions Options() {
    MappingClientOptions options;
    options.server = server_->address();
    options.map = "mine";
    options.mission = kAnna;
    options.min_time_between_comparisons = absl::InfiniteDuration();
    options.log = [this](LogLevel, absl::string_view message) {
      absl::MutexLock lock(&mutex_);
      robot_log_.append(message.data(), message.size()).append("\n");
    };
    return options;
  }
  void Connect(const MappingClientOptions& options) {
    auto client = MappingClient::Create(options, &robot_);
    ASSERT_TRUE(client.ok()) << client.status();
    client_ = *std::move(client);
  }

  // Uploads a mission, and lets it compare once with the server's map.
  void DriveAndCompare() {
    Matrix6d covariance = 1e-4 * Matrix6d::Identity();
    const Submap submap = testing::MakeSubmap(0, 0, kKeyframes);
    Rigid3d last;
    for (int64_t i = 0; i < kKeyframes; ++i) {
      const Keyframe& keyframe = submap.keyframes[i];
      const Rigid3d motion = last.Inverse() * keyframe.mission_from_body;
      ASSERT_TRUE(robot_.AddKeyframe(i, keyframe.stamp, motion, covariance).ok());
      last = keyframe.mission_from_body;
    }
    ASSERT_TRUE(client_->AddSubmap(submap).ok());
    ASSERT_TRUE(client_->WaitUntilAcknowledged(kPatience).ok());
    const uint64_t revision = Settle("mine").revision();
    ASSERT_TRUE(client_->WaitForKeyframe(kKeyframes - 1, revision, kPatience).ok());
    const auto report = client_->Synchronize();
    ASSERT_TRUE(report.ok()) << report.status();
  }

  v1::Robot Anna() {
    v1::ListRobotsRequest request;
    request.set_map("mine");
    const auto response =
        Call<v1::ListRobotsResponse>(&v1::MapAdminService::Stub::ListRobots, request);
    return response.robots_size() == 1 ? response.robots(0) : v1::Robot();
  }
  v1::Robot AnnaWhenReported() {
    const auto deadline = testing::Deadline();
    v1::Robot robot = Anna();
    while (!robot.report().has_comparison() && std::chrono::system_clock::now() < deadline) {
      std::this_thread::yield();
      robot = Anna();
    }
    return robot;
  }
  std::string RobotLog() {
    absl::MutexLock lock(&mutex_);
    return robot_log_;
  }
  // Between "(request " and ")".
  static std::string RequestIn(const std::string& text) {
    const size_t begin = text.find("(request ");
    if (begin == std::string::npos) return "none in: " + text;
    return text.substr(begin + 9, text.find(')', begin) - begin - 9);
  }

  std::shared_ptr<spdlog::logger> before_;
  std::ostringstream log_;
  absl::Mutex mutex_;
  std::string robot_log_ ABSL_GUARDED_BY(mutex_);
  OnboardEstimator robot_;
  std::unique_ptr<MappingClient> client_;
};

TEST_F(RobotStatusTest, AnOperatorSeesLinkAndComparison) {
  Connect(Options());
  DriveAndCompare();
  const v1::Robot robot = AnnaWhenReported();
  const uint64_t revision = client_->Stats().revision;
  EXPECT_EQ(robot.report().mission().robot(), "anna");
  EXPECT_EQ(robot.report().comparison().revision(), revision);
  EXPECT_EQ(robot.report().comparison().nodes(), kKeyframes);
  EXPECT_EQ(robot.report().link().submaps_waiting(), 0);
  EXPECT_GT(robot.report().link().bytes_sent(), 0);
  EXPECT_TRUE(robot.watching());
  EXPECT_EQ(robot.revision_sent(), revision);
  EXPECT_GT(robot.bytes_received(), 0);
  EXPECT_GT(robot.bytes_sent(), 0);

  v1::GetStatusReportRequest request;
  request.set_map("mine");
  *request.mutable_mission() = ToProto(kAnna);
  const auto response =
      Call<v1::GetStatusReportResponse>(&v1::MapAdminService::Stub::GetStatusReport, request);
  EXPECT_EQ(response.report().comparison().index_size(), kKeyframes);
  EXPECT_EQ(response.report().comparison().large_size(), kKeyframes);
  const MappingClientStats stats = client_->Stats();
  EXPECT_GT(stats.report_bytes_sent, 0);
  EXPECT_LT(stats.report_bytes_sent, stats.bytes_sent);
}

TEST_F(RobotStatusTest, WhoDoesNotReportIsNotReportedOf) {
  MappingClientOptions options = Options();
  options.report_status = false;
  Connect(options);
  DriveAndCompare();
  client_.reset();
  EXPECT_FALSE(Anna().has_report());
}

TEST_F(RobotStatusTest, AnOperatorsErrorIsFoundInTheLog) {
  AdminClient admin(server_->address(), kPatience);
  const absl::Status status = admin.VerifyMap("nowhere").status();
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  const std::string id = RequestIn(std::string(status.message()));
  server_.reset();
  EXPECT_THAT(log_.str(), HasSubstr("(request " + id + ")"));
  EXPECT_THAT(log_.str(), HasSubstr("MapAdminService/VerifyMap"));
}

TEST_F(RobotStatusTest, ARobotsErrorIsFoundInTheLog) {
  ServerOptions options = testing::TestOptions();
  options.quotas.max_streams = 1;  // a robot needs two
  server_.reset();
  StartServer(options);
  Connect(Options());
  const auto deadline = testing::Deadline();
  while (RobotLog().find("(request ") == std::string::npos &&
         std::chrono::system_clock::now() < deadline) {
    std::this_thread::yield();
  }
  const std::string id = RequestIn(RobotLog());
  client_.reset();
  server_.reset();
  EXPECT_THAT(log_.str(), HasSubstr("(request " + id + ")"));
  EXPECT_THAT(log_.str(), HasSubstr("RESOURCE_EXHAUSTED"));
}

}  // namespace
}  // namespace overtone
