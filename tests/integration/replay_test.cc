// SPDX-License-Identifier: Apache-2.0
// `overtone replay` as a user runs it: real processes, real RPCs, files at the end.
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "overtone/client/cli/child_process.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;
using Json = nlohmann::json;

const std::string kProgram = OVERTONE_PROGRAM;
const std::string kData = std::string(OVERTONE_SOURCE_DIR) + "/../shared/data/euroc";

absl::Status NotInterrupted() { return absl::OkStatus(); }

std::string ReadFile(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

class ReplayTest : public ::testing::Test {
 protected:
  ReplayTest() {
    folder_ = ::testing::TempDir() + "overtone_replay_" + std::to_string(getpid());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~ReplayTest() override { std::filesystem::remove_all(folder_); }

  std::string log_path() const { return folder_ + "/stderr.txt"; }

  std::unique_ptr<ChildProcess> Start(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), {kProgram, "replay", "--out", folder_});
    auto child = ChildProcess::Start({"replay", arguments, log_path()});
    EXPECT_TRUE(child.ok()) << child.status();
    return child.ok() ? *std::move(child) : nullptr;
  }

  // Runs to the end; the message says how it ended.
  static absl::Status Wait(ChildProcess* child) {
    for (;;) {
      const auto line = child->ReadLine(absl::Minutes(8), NotInterrupted);
      if (!line.ok()) return line.status();
    }
  }

  // The log once `text` is in it; another process writes it, so there is nothing to wait on.
  std::string LogWith(const std::string& text) const {
    for (int i = 0; i < 3000; ++i) {
      const std::string log = ReadFile(log_path());
      if (log.find(text) != std::string::npos) return log;
      usleep(10000);
    }
    return "";
  }

  // Of the progress line "Mapping server PID listens on ...".
  pid_t ServerPid() const {
    const std::string log = LogWith(" listens on ");
    int pid = -1;
    return sscanf(log.c_str(), "Mapping server %d", &pid) == 1 ? pid : -1;
  }

  Json Metrics() const { return Json::parse(ReadFile(folder_ + "/metrics.json")); }

  std::string folder_;
};

TEST_F(ReplayTest, TheExampleEndsWithBetterTrajectoriesAndAllItsFiles) {
  const auto child = Start({"--dataset", "example", "--example-duration", "200"});
  ASSERT_NE(child, nullptr);
  EXPECT_EQ(Wait(child.get()).message(), "replay ended with exit code 0") << ReadFile(log_path());
  const Json metrics = Metrics();
  ASSERT_EQ(metrics.at("robots").size(), 3);
  EXPECT_TRUE(metrics.at("closures").at("simulated").get<bool>());
  for (const Json& robot : metrics.at("robots")) {
    const std::string name = robot.at("name");
    EXPECT_GT(robot.at("comparisons").size(), 5) << name;
    EXPECT_GT(robot.at("bytes_up").get<int64_t>(), 0) << name;
    EXPECT_GT(robot.at("bytes_down").get<int64_t>(), 0) << name;
    const double onboard = robot.at("onboard").at("rmse_m");
    EXPECT_LT(robot.at("corrected").at("rmse_m").get<double>(), 1.05 * onboard) << name;
    for (const char* file : {"onboard.tum", "server.tum", "corrected.tum"}) {
      const std::string text = ReadFile(folder_ + "/" + name + "/" + file);
      const auto lines = std::count(text.begin(), text.end(), '\n');  // the first is a comment
      EXPECT_EQ(lines - 1, robot.at("keyframes").get<int>()) << name << " " << file;
    }
  }
  EXPECT_THAT(ReadFile(folder_ + "/constraints.csv"), HasSubstr("robot,id,kind,from,to,score"));
  EXPECT_THAT(ReadFile(folder_ + "/closures.csv"), HasSubstr(",yes,no,robot,yes,"));
  EXPECT_THAT(ReadFile(folder_ + "/report.html"), HasSubstr("SIMULATED"));
}

TEST_F(ReplayTest, AServerThatDiesIsReportedAndNobodyIsLeftBehind) {
  const auto child = Start({"--dataset", "example", "--example-duration", "300", "--speed", "20"});
  ASSERT_NE(child, nullptr);
  const pid_t server = ServerPid();
  ASSERT_GT(server, 0);
  ASSERT_NE(LogWith(" s of "), "");  // under way
  ASSERT_EQ(kill(server, SIGKILL), 0);
  EXPECT_EQ(Wait(child.get()).message(), "replay ended with exit code 1");
  EXPECT_THAT(ReadFile(log_path()), HasSubstr("mapping server was ended by signal 9; see "));
  EXPECT_EQ(kill(server, 0), -1);
}

TEST_F(ReplayTest, AServerThatDiesAtOnceIsReportedToo) {
  const auto child = Start({"--dataset", "example", "--example-duration", "300", "--speed", "20"});
  ASSERT_NE(child, nullptr);
  const pid_t server = ServerPid();
  ASSERT_GT(server, 0);
  ASSERT_EQ(kill(server, SIGKILL), 0);
  EXPECT_EQ(Wait(child.get()).message(), "replay ended with exit code 1");
  EXPECT_THAT(ReadFile(log_path()), HasSubstr("mapping server was ended by signal 9; see "));
}

// A server of the user's own, killed on the way and started again.
TEST_F(ReplayTest, AServerThatReturnsIsWaitedForAndAMissionIsReplayedOnce) {
  std::string address = "127.0.0.1:0";
  const auto start_server = [&] {
    auto server = ChildProcess::Start(
        {"server",
         {OVERTONE_SERVER, "--listen", address, "--data-dir", folder_ + "/data"},
         folder_ + "/server.txt"});
    EXPECT_TRUE(server.ok()) << server.status();
    const auto line = (*server)->ReadLine(absl::Seconds(30), NotInterrupted);
    EXPECT_TRUE(line.ok()) << line.status();
    address = line->substr(std::string("listening on ").size());
    return *std::move(server);
  };
  auto server = start_server();
  const std::vector<std::string> arguments = {"--dataset", "example", "--example-duration", "200",
                                              "--speed",   "20",      "--server",           address,
                                              "--map",     "town"};
  auto child = Start(arguments);
  ASSERT_NE(child, nullptr);
  ASSERT_NE(LogWith(" s of "), "");  // under way
  ASSERT_EQ(kill(server->pid(), SIGKILL), 0);
  server.reset();
  ASSERT_NE(LogWith("server " + address + " cannot be reached; going on when it returns"), "")
      << ReadFile(log_path());
  server = start_server();
  EXPECT_EQ(Wait(child.get()).message(), "replay ended with exit code 0") << ReadFile(log_path());
  EXPECT_THAT(ReadFile(log_path()), HasSubstr("server " + address + " is back\n"));
  EXPECT_EQ(Metrics().at("robots").size(), 3);

  child = Start(arguments);
  ASSERT_NE(child, nullptr);
  EXPECT_EQ(Wait(child.get()).message(), "replay ended with exit code 1");
  const std::string log = ReadFile(log_path());
  EXPECT_THAT(log, HasSubstr("map town has a mission "));
  EXPECT_THAT(log, HasSubstr("/run already: --mission NAME replays beside it"));
}

TEST_F(ReplayTest, AnInterruptEndsEverythingInGoodOrder) {
  const auto child = Start({"--dataset", "example", "--example-duration", "300", "--speed", "20"});
  ASSERT_NE(child, nullptr);
  const pid_t server = ServerPid();
  ASSERT_GT(server, 0);
  ASSERT_EQ(kill(child->pid(), SIGINT), 0);
  EXPECT_EQ(Wait(child.get()).message(), "replay ended with exit code 130");
  EXPECT_THAT(ReadFile(log_path()), HasSubstr("overtone replay: interrupted"));
  EXPECT_EQ(kill(server, 0), -1);
  EXPECT_THAT(ReadFile(folder_ + "/server.log"), HasSubstr("shutting down"));
}

// Not fresh, the map has these missions already and never gets what the second replay waits for.
TEST_F(ReplayTest, BeginsAMapAnewWhenItIsToBeFresh) {
  const auto server =
      ChildProcess::Start({"server",
                           {OVERTONE_SERVER, "--listen", "127.0.0.1:0", "--data-dir", ":memory:"},
                           folder_ + "/server.txt"});
  ASSERT_TRUE(server.ok()) << server.status();
  const auto line = (*server)->ReadLine(absl::Minutes(1), NotInterrupted);
  ASSERT_TRUE(line.ok()) << line.status();
  const std::string address = line->substr(line->rfind(' ') + 1);
  for (int i = 0; i < 2; ++i) {
    const auto child = Start({"--dataset", "example", "--example-duration", "40", "--server",
                              address, "--map", "again", "--fresh", "--timeout", "60"});
    ASSERT_NE(child, nullptr);
    EXPECT_EQ(Wait(child.get()).message(), "replay ended with exit code 0") << ReadFile(log_path());
  }
}

TEST_F(ReplayTest, WrongInputIsSaidInOneSentence) {
  const auto child = Start({"--dataset", "tum", "--robot", "a:/nowhere.tum"});
  ASSERT_NE(child, nullptr);
  EXPECT_EQ(Wait(child.get()).message(), "replay ended with exit code 2");
  EXPECT_THAT(ReadFile(log_path()), HasSubstr("overtone replay: /nowhere.tum"));
}

TEST_F(ReplayTest, CorrectsRealVisualInertialOdometry) {
  if (!std::filesystem::exists(kData)) GTEST_SKIP() << kData << " is not there";
  std::vector<std::string> arguments = {"--dataset", "euroc", "--closures-from-ground-truth",
                                        "radius=1,sigma_t=0.03,sigma_r=0.00873,outliers=0"};
  for (const char* name : {"MH_01", "MH_02", "MH_03"}) {
    arguments.push_back("--robot");
    arguments.push_back(std::string(name) + ":" + kData + "/odometry_cppt/" + name +
                        ".txt:" + kData + "/gt/" + name + ".txt");
  }
  const auto child = Start(arguments);
  ASSERT_NE(child, nullptr);
  EXPECT_EQ(Wait(child.get()).message(), "replay ended with exit code 0") << ReadFile(log_path());
  const Json metrics = Metrics();
  ASSERT_EQ(metrics.at("robots").size(), 3);
  for (const Json& robot : metrics.at("robots")) {
    const double onboard = robot.at("onboard").at("rmse_m");
    const double server = robot.at("server").at("rmse_m");
    const double corrected = robot.at("corrected").at("rmse_m");
    std::cout << robot.at("name") << " onboard " << onboard << " server " << server << " corrected "
              << corrected << " m\n";
    EXPECT_LE(server, 0.03);
    EXPECT_LE(corrected, onboard);
  }
}

}  // namespace
}  // namespace overtone
