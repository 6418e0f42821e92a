// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <fstream>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/client_flags.h"
#include "overtone/client/cli/closure_file.h"
#include "overtone/client/cli/motion_noise.h"
#include "overtone/client/cli/robot_recording_file.h"
#include "overtone/client/cli/tls_flags.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

ClientFlags Parse(std::vector<std::string> arguments) {
  CLI::App app;
  ClientFlags flags;
  AddClientFlags(&app, &flags);
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants them
  app.parse(arguments);
  return flags;
}

TEST(ClientFlags, ARobotProcessGetsExactlyWhatTheReplayGot) {
  ClientFlags flags;
  flags.strategy = "uniform";
  flags.metric = "so3_trace";
  flags.signal = "se3_log";
  flags.signal_weights = "prototype";
  flags.encoding = "plain";
  flags.n = 3;
  flags.scales = 9;
  flags.max_nodes = 77;
  flags.min_discrepancy = 0.25;
  flags.multi_robot_graph = true;
  flags.seed = 12345;
  const ClientFlags again = Parse(flags.ToArguments());
  EXPECT_EQ(again.ToArguments(), flags.ToArguments());
  MappingClientOptions options;
  again.ApplyTo(&options);
  EXPECT_EQ(options.synchronization.selection.strategy, SelectionStrategy::kUniform);
  EXPECT_EQ(options.synchronization.selection.n, 3);
  EXPECT_EQ(options.synchronization.selection.min_discrepancy, 0.25);
  EXPECT_EQ(options.synchronization.selection.seed, 12345);
  EXPECT_EQ(options.synchronization.graph.metric, DistanceMetric::kSo3Trace);
  EXPECT_EQ(options.synchronization.signal, SignalKind::kSe3Log);
  EXPECT_EQ(options.synchronization.wavelets.num_scales, 9);
  EXPECT_EQ(options.synchronization.signal_weights.diagonal[0], 10);
  EXPECT_EQ(options.max_nodes, 77);
  EXPECT_FALSE(options.compact);
  EXPECT_TRUE(options.whole_map);
}

TEST(ClientFlags, TheDefaultsAreTheLibrarysOwn) {
  MappingClientOptions options;
  const SynchronizationOptions before = options.synchronization;
  ClientFlags().ApplyTo(&options);
  EXPECT_EQ(options.synchronization.selection.strategy, before.selection.strategy);
  EXPECT_EQ(options.synchronization.selection.n, before.selection.n);
  EXPECT_EQ(options.synchronization.wavelets.num_scales, before.wavelets.num_scales);
  EXPECT_EQ(options.synchronization.graph.metric, before.graph.metric);
  EXPECT_TRUE(options.compact);
}

TEST(ClientFlags, UnknownNamesAreRefused) {
  EXPECT_THROW(Parse({"--strategy=luck"}), CLI::ValidationError);
  EXPECT_THROW(Parse({"--metric=miles"}), CLI::ValidationError);
  EXPECT_THROW(Parse({"--scales=2"}), CLI::ValidationError);
}

TEST(MotionNoise, IsReadOverTheDefaults) {
  const auto noise = ParseMotionNoise("rotation=0.5", {0.1, 0.2, 0.3});
  ASSERT_TRUE(noise.ok());
  EXPECT_EQ(noise->translation_per_sqrt_m, 0.1);
  EXPECT_EQ(noise->rotation_per_sqrt_m, 0.5);
  EXPECT_FALSE(ParseMotionNoise("rotation=0", {}).ok());
  EXPECT_FALSE(ParseMotionNoise("rotation=x", {}).ok());
}

RobotRecording Recording() {
  RobotRecording recording;
  recording.id = {"a", "run"};
  for (int i = 0; i < 3; ++i) {
    Keyframe keyframe;
    keyframe.stamp.ns = 1403636580838555648 + i;
    keyframe.mission_from_body = Rigid3d(ExpSO3({0.1 * i, 0.3, 0}), {1.0 / 3, double(i), -2e-7});
    keyframe.motion_covariance(0, 5) = keyframe.motion_covariance(5, 0) = 0.1 * i;
    keyframe.degenerate = i == 1;
    recording.keyframes.push_back(keyframe);
  }
  LoopClosure closure;
  closure.from = {{"b", "run"}, 17};
  closure.to = {recording.id, 2};
  closure.from_tform_to = recording.keyframes[1].mission_from_body;
  recording.closures.push_back(closure);
  return recording;
}

std::string TemporaryPath(const std::string& name) {
  return ::testing::TempDir() + std::to_string(getpid()) + "_" + name;
}

TEST(RobotRecordingFile, ReadsBackWhatWasWritten) {
  const RobotRecording recording = Recording();
  const std::string path = TemporaryPath("recording.json");
  ASSERT_TRUE(WriteRobotRecording(path, recording).ok());
  const auto again = ReadRobotRecording(path);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->id, recording.id);
  ASSERT_EQ(again->keyframes.size(), 3);
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(again->keyframes[i].stamp, recording.keyframes[i].stamp);
    EXPECT_EQ(again->keyframes[i].degenerate, recording.keyframes[i].degenerate);
    EXPECT_EQ(again->keyframes[i].motion_covariance, recording.keyframes[i].motion_covariance);
    EXPECT_LT(Log(again->keyframes[i].mission_from_body.Inverse() *
                  recording.keyframes[i].mission_from_body)
                  .norm(),
              1e-14);
  }
  ASSERT_EQ(again->closures.size(), 1);
  EXPECT_EQ(again->closures[0].from, recording.closures[0].from);
  EXPECT_EQ(again->closures[0].to, recording.closures[0].to);
}

TEST(RobotRecordingFile, WrongFilesAreRefusedByName) {
  const std::string path = TemporaryPath("bad.json");
  const auto error_of = [&path](const std::string& text) {
    std::ofstream(path) << text;
    return std::string(ReadRobotRecording(path).status().message());
  };
  EXPECT_THAT(error_of("{"), HasSubstr("bad.json"));
  EXPECT_THAT(error_of("{\"robot\":\"a\",\"mission\":\"run\"}"), HasSubstr("keyframes"));
  EXPECT_THAT(error_of("{\"robot\":\"A b\",\"mission\":\"run\",\"keyframes\":[],"
                       "\"loop_closures\":[]}"),
              HasSubstr("robot"));
  EXPECT_EQ(ReadRobotRecording("/nowhere.json").status().code(), absl::StatusCode::kNotFound);
}

RobotPlan Plan(const std::string& name) {
  Trajectory odometry;
  ::overtone::Recording recording;
  recording.name = name;
  recording.id = {name, "run"};
  for (int i = 0; i < 100; ++i) {
    recording.odometry.push_back({Timestamp{1'000'000'000LL * (100 + i)},
                                  Rigid3d(Eigen::Quaterniond::Identity(), {double(i), 0, 0})});
    recording.frames.push_back(i);
  }
  return *MakeRobotPlan(recording, {1, 10}, MotionNoise());
}

TEST(ClosureFile, WhatARunWritesCanBeReadAgain) {
  const std::vector<RobotPlan> plans = {Plan("a"), Plan("b")};
  RunResult result;
  for (const RobotPlan& plan : plans) {
    RobotResult robot;
    robot.name = plan.name;
    for (const Keyframe& keyframe : plan.keyframes) robot.stamps.push_back(keyframe.stamp);
    result.robots.push_back(robot);
  }
  ClosureResult row;
  row.closure.from = {{"a", "run"}, 3};
  row.closure.to = {{"b", "run"}, 42};
  row.closure.from_tform_to = Rigid3d(ExpSO3({0.1, 0.2, 0.3}), {1, 2, 3});
  row.closure.covariance.diagonal() << 0.01, 0.01, 0.01, 0.0004, 0.0004, 0.0004;
  row.verdict = "accepted";
  row.simulated = true;
  result.closures.push_back(row);
  const std::string path = TemporaryPath("closures.csv");
  ASSERT_TRUE(WriteClosures(path, result).ok());
  const auto again = ReadClosures(path, plans);
  ASSERT_TRUE(again.ok()) << again.status();
  ASSERT_EQ(again->size(), 1);
  EXPECT_EQ((*again)[0].from, row.closure.from);
  EXPECT_EQ((*again)[0].to, row.closure.to);
  EXPECT_LT(Log((*again)[0].from_tform_to.Inverse() * row.closure.from_tform_to).norm(), 1e-7);
  EXPECT_LT(((*again)[0].covariance - row.closure.covariance).norm(), 1e-9);
}

TEST(ClosureFile, WhatTheServerFoundIsNotTheRobotsWord) {
  const std::vector<RobotPlan> plans = {Plan("a"), Plan("b")};
  RunResult result;
  for (const RobotPlan& plan : plans) {
    result.robots.emplace_back();
    result.robots.back().name = plan.name;
    result.robots.back().stamps = plan.stamps;
  }
  for (const char* proposer : {"robot", "scan_context", "robot_score"}) {
    ClosureResult row;
    row.closure.from = {{"a", "run"}, 0};
    row.closure.to = {{"b", "run"}, 1};
    row.proposer = proposer;
    row.truth = ClosureTruth();
    result.closures.push_back(row);
  }
  const std::string path = TemporaryPath("closures.csv");
  ASSERT_TRUE(WriteClosures(path, result).ok());
  const auto again = ReadClosures(path, plans);
  ASSERT_TRUE(again.ok()) << again.status();
  EXPECT_EQ(again->size(), 1);
}

TEST(ClosureFile, ErrorsNameTheLine) {
  const std::vector<RobotPlan> plans = {Plan("a"), Plan("b")};
  const std::string path = TemporaryPath("bad.csv");
  const std::string header =
      "from_robot,from_stamp_s,to_robot,to_stamp_s,x,y,z,qx,qy,qz,qw,sigma_t,sigma_r\n";
  const auto error_of = [&](const std::string& row) {
    std::ofstream(path) << header << row << "\n";
    return std::string(ReadClosures(path, plans).status().message());
  };
  EXPECT_EQ(error_of("a,103,b,142,1,2,3,0,0,0,1,0.1,0.02"), "");
  EXPECT_THAT(error_of("c,103,b,142,1,2,3,0,0,0,1,0.1,0.02"), HasSubstr("bad.csv:2: no robot"));
  EXPECT_THAT(error_of("a,1,b,142,1,2,3,0,0,0,1,0.1,0.02"), HasSubstr("no odometry near 1"));
  EXPECT_THAT(error_of("a,103,b,142,nan,2,3,0,0,0,1,0.1,0.02"), HasSubstr("bad.csv:2"));
  EXPECT_THAT(error_of("a,103,b,142,1,2,3,0,0,0,1,0,0.02"), HasSubstr("sigma_t"));
  EXPECT_THAT(error_of("a,103"), HasSubstr("columns"));
  std::ofstream(path) << "x,y\n";
  EXPECT_THAT(std::string(ReadClosures(path, plans).status().message()), HasSubstr("first line"));
}

TlsFiles ParseTls(std::vector<std::string> arguments) {
  CLI::App app;
  TlsFiles tls;
  AddTlsFlags(&app, &tls);
  std::reverse(arguments.begin(), arguments.end());
  app.parse(arguments);
  return tls;
}

TEST(TlsFlags, ARobotProcessGetsItsOwnCertificateWhateverTheEnvironmentSays) {
  setenv("OVERTONE_TLS_CA", "env/ca.crt", 1);
  setenv("OVERTONE_TLS_KEY", "env/operator.key", 1);
  const TlsFiles operators = ParseTls({"--tls-cert=olga.crt", "--tls-server-name=map"});
  EXPECT_EQ(operators.ca_file, "env/ca.crt");
  EXPECT_EQ(operators.key_file, "env/operator.key");
  const TlsFiles robots = ParseTls(TlsArguments(TlsFilesOfRobot(operators, "certs", "anna")));
  EXPECT_EQ(robots.ca_file, "env/ca.crt");
  EXPECT_EQ(robots.certificate_file, "certs/robot-anna.crt");
  EXPECT_EQ(robots.key_file, "certs/robot-anna.key");
  EXPECT_EQ(robots.server_name, "map");
  ClearTlsEnvironment();
  EXPECT_FALSE(ParseTls({}).enabled());
}

TEST(TlsFlags, ErrorsNameTheFlag) {
  TlsFiles tls;
  EXPECT_TRUE(CheckTlsFlags(tls, "localhost:7077").ok());
  EXPECT_THAT(std::string(CheckTlsFlags(tls, "map.example.org:7077").message()),
              ::testing::AllOf(HasSubstr("--tls-ca"), HasSubstr("--insecure")));
  tls.ca_file = tls.certificate_file = "/nowhere";
  EXPECT_THAT(std::string(CheckTlsFlags(tls, "localhost:7077").message()),
              ::testing::StartsWith("--tls-key: missing"));
  tls.key_file = "/nowhere";
  EXPECT_THAT(std::string(CheckTlsFlags(tls, "localhost:7077").message()),
              ::testing::StartsWith("--tls-ca: /nowhere: cannot be read"));
}

}  // namespace
}  // namespace overtone
