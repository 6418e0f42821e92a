// SPDX-License-Identifier: Apache-2.0
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "nlohmann/json.hpp"
#include "overtone/client/cli/simulate_command.h"
#include "overtone/client/cli/simulation_files.h"
#include "overtone/core/common/parse_number.h"
#include "overtone/core/geometry/trajectory_io.h"
#include "overtone/core/graph/point_cloud_io.h"

namespace overtone {
namespace {

namespace fs = std::filesystem;
using ::testing::HasSubstr;

// Removed with what is in it.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const std::string& name)
      : path_(::testing::TempDir() + std::to_string(getpid()) + "_" + name) {}
  ~TemporaryFolder() { fs::remove_all(path_); }
  const std::string& path() const { return path_; }

 private:
  std::string path_;
};

// As main() does it: parse, then run what was chosen. -1: the parser refused.
int RunCommand(std::vector<std::string> arguments) {
  CLI::App app;
  std::function<int()> run;
  AddSimulateCommand(&app, &run);
  arguments.insert(arguments.begin(), "simulate");
  std::reverse(arguments.begin(), arguments.end());  // as CLI11 wants them
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError&) {
    return -1;
  }
  return run();
}

std::string ReadText(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  EXPECT_TRUE(file.good()) << path;
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

// Relative path to contents.
std::map<std::string, std::string> FilesOf(const std::string& folder) {
  std::map<std::string, std::string> files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    if (!entry.is_regular_file()) continue;
    files[fs::relative(entry.path(), folder).string()] = ReadText(entry.path().string());
  }
  return files;
}

Trajectory ReadKitti(const std::string& path) {
  const auto trajectory = ReadTrajectory(path, TrajectoryFormat::kKitti);
  EXPECT_TRUE(trajectory.ok()) << trajectory.status();
  return trajectory.ok() ? *trajectory : Trajectory();
}

const std::vector<std::string> kSmall = {"--length=40", "--columns=90", "--rings=4"};

std::vector<std::string> Small(const std::string& out, std::vector<std::string> more) {
  more.insert(more.end(), kSmall.begin(), kSmall.end());
  more.push_back("--out=" + out);
  return more;
}

TEST(Simulate, WhatIsWrittenReadsBackAsWhatWasSimulated) {
  const TemporaryFolder out("simulate_round_trip");
  ScenarioOptions options;
  options.scene = "corridor";
  options.failures.degenerate = true;
  options.length_m = 120;
  LidarOptions lidar_options;
  lidar_options.columns = 90;
  int reports = 0;
  const auto written = WriteSimulation(options, lidar_options, out.path(),
                                       [&reports](const SimulatedFolder&) { ++reports; });
  ASSERT_TRUE(written.ok()) << written.status();
  EXPECT_EQ(reports, 2);
  const auto scenario = SimulateScenario(options);
  const auto lidar = Lidar::Create(lidar_options);
  ASSERT_EQ(written->size(), scenario->robots.size());
  for (const ScenarioRobot& robot : scenario->robots) {
    const std::string folder = out.path() + "/" + robot.name;
    const Trajectory odometry = ReadKitti(folder + "/odom_poses.txt");
    const Trajectory truth = ReadKitti(folder + "/ground_truth.txt");
    std::ifstream times(folder + "/times.txt"), flags(folder + "/degenerate.txt");
    ASSERT_EQ(odometry.size(), robot.odometry.size());
    ASSERT_EQ(truth.size(), robot.odometry.size());
    for (size_t i = 0; i < odometry.size(); ++i) {
      EXPECT_LT(Log(odometry[i].pose.Inverse() * robot.odometry[i].pose).norm(), 1e-9);
      EXPECT_LT(Log(truth[i].pose.Inverse() * robot.ground_truth[i].pose).norm(), 1e-9);
      std::string time;
      ASSERT_TRUE(std::getline(times, time));
      EXPECT_EQ(*ParseSeconds(time), robot.odometry[i].stamp);
      char name[16];
      snprintf(name, sizeof(name), "%06d.pcd", static_cast<int>(i));
      const auto cloud = ReadPointCloud(folder + "/Scans/" + name);
      ASSERT_TRUE(cloud.ok()) << cloud.status();
      EXPECT_EQ(cloud->points, robot.Scan(scenario->world, *lidar, static_cast<int>(i)).points);
    }
    ASSERT_FALSE(robot.degenerate.empty());
    for (const auto& [index, direction] : robot.degenerate) {
      int k;
      Eigen::Vector3d d;
      ASSERT_TRUE(flags >> k >> d.x() >> d.y() >> d.z());
      EXPECT_EQ(k, index);
      EXPECT_EQ(d, direction);
    }
    std::string more;
    EXPECT_FALSE(flags >> more);
    EXPECT_FALSE(times >> more);
  }
}

TEST(Simulate, TheCommandLeavesExactlyTheseFiles) {
  const TemporaryFolder out("simulate_files");
  ASSERT_EQ(RunCommand(Small(out.path(),
                             {"--robots=2", "--keyframe-distance=1000", "--keyframe-rotation=10"})),
            0);
  std::vector<std::string> names;
  for (const auto& [name, text] : FilesOf(out.path())) names.push_back(name);
  std::vector<std::string> expected = {"scenario.json"};
  for (const std::string robot : {"robot1/", "robot2/"}) {
    for (const char* name : {"odom_poses.txt", "times.txt", "ground_truth.txt"}) {
      expected.push_back(robot + name);
    }
    for (const char* digit : {"0", "1"}) {  // the first and the last keyframe
      expected.push_back(robot + "Scans/00000" + digit + ".pcd");
    }
  }
  EXPECT_THAT(names, testing::UnorderedElementsAreArray(expected));
}

TEST(Simulate, TheSameOptionsGiveTheSameBytesAndAnotherSeedOthers) {
  const TemporaryFolder a("simulate_a"), b("simulate_b"), c("simulate_c");
  ASSERT_EQ(RunCommand(Small(a.path(), {"--scenario=tunnel", "--seed=5"})), 0);
  ASSERT_EQ(RunCommand(Small(b.path(), {"--scenario=tunnel", "--seed=5"})), 0);
  ASSERT_EQ(RunCommand(Small(c.path(), {"--scenario=tunnel", "--seed=6"})), 0);
  EXPECT_EQ(FilesOf(a.path()), FilesOf(b.path()));
  EXPECT_NE(FilesOf(a.path())["robot1/Scans/000000.pcd"],
            FilesOf(c.path())["robot1/Scans/000000.pcd"]);
}

TEST(Simulate, TheRecordSaysWhatWasAskedFor) {
  const TemporaryFolder out("simulate_record");
  ASSERT_EQ(RunCommand(Small(out.path(), {"--scenario=terrace", "--seed=9", "--noise=0.5",
                                          "--failures=yaw_drift,jump", "--jump=2.5",
                                          "--fov-deg=120", "--range-noise=0"})),
            0);
  const auto record = nlohmann::json::parse(ReadText(out.path() + "/scenario.json"));
  const auto& scenario = record["scenario"];
  EXPECT_EQ(scenario["scene"], "terrace");
  EXPECT_EQ(scenario["seed"], 9);
  EXPECT_EQ(scenario["length_m"], 40);
  EXPECT_EQ(scenario["odometry"]["scale_sigma"], 0.0015);
  EXPECT_EQ(scenario["failures"]["yaw_drift"], true);
  EXPECT_EQ(scenario["failures"]["degenerate"], false);
  EXPECT_EQ(scenario["failures"]["jump"], true);
  EXPECT_EQ(scenario["failures"]["jump_m"], 2.5);
  EXPECT_EQ(record["lidar"]["rings"], 4);
  EXPECT_EQ(record["lidar"]["columns"], 90);
  EXPECT_EQ(record["lidar"]["horizontal_fov_deg"], 120);
  EXPECT_EQ(record["lidar"]["range_sigma_m"], 0);
  EXPECT_EQ(record["terrace"].size(), 4u);
  EXPECT_TRUE(record["corridor"].is_null());
  EXPECT_EQ(record["robots"].size(), 3u);
}

TEST(Simulate, ThePlanarSensorMayBeAltered) {
  const TemporaryFolder out("simulate_planar");
  ASSERT_EQ(RunCommand({"--sensor=planar", "--columns=360", "--length=10", "--robots=1",
                        "--out=" + out.path()}),
            0);
  const auto cloud = ReadPointCloud(out.path() + "/robot1/Scans/000000.pcd");
  ASSERT_TRUE(cloud.ok());
  EXPECT_LE(cloud->size(), 270u);
  EXPECT_GT(cloud->size(), 200u);
}

TEST(Simulate, AFolderWithSomethingInItIsLeftAlone) {
  const TemporaryFolder out("simulate_occupied");
  fs::create_directories(out.path());
  std::ofstream(out.path() + "/precious") << "1";
  EXPECT_EQ(RunCommand(Small(out.path(), {})), 2);
  EXPECT_EQ(FilesOf(out.path()).size(), 1u);
}

TEST(Simulate, KeepsWhatIsThereWholeAndMakesAnewWhatWasInterrupted) {
  const TemporaryFolder out("simulate_keep"), draft("simulate_keep.part");
  fs::create_directories(draft.path() + "/robot9");
  ASSERT_EQ(RunCommand(Small(out.path(), {"--keep", "--seed=5"})), 0);
  EXPECT_FALSE(fs::exists(draft.path()));
  EXPECT_FALSE(fs::exists(out.path() + "/robot9"));
  const std::map<std::string, std::string> files = FilesOf(out.path());
  ASSERT_EQ(files.count("scenario.json"), 1u);
  ASSERT_EQ(RunCommand(Small(out.path(), {"--keep", "--seed=6"})), 0);
  EXPECT_EQ(FilesOf(out.path()), files);
}

TEST(Simulate, KeepingStillLeavesAFolderOfOtherThingsAlone) {
  const TemporaryFolder out("simulate_keep_occupied"), draft("simulate_keep_occupied.part");
  fs::create_directories(out.path());
  std::ofstream(out.path() + "/precious") << "1";
  EXPECT_EQ(RunCommand(Small(out.path(), {"--keep"})), 1);
  EXPECT_EQ(FilesOf(out.path()).size(), 1u);
}

TEST(Simulate, WrongOptionsAreRefusedBeforeAnythingIsWritten) {
  const TemporaryFolder out("simulate_refused");
  EXPECT_EQ(RunCommand(Small(out.path(), {"--scenario=moon"})), -1);
  EXPECT_EQ(RunCommand(Small(out.path(), {"--failures=gremlins"})), -1);
  EXPECT_EQ(RunCommand(Small(out.path(), {"--robots=0"})), -1);
  EXPECT_EQ(RunCommand(Small(out.path(), {"--failures=degenerate"})), 2);  // tunnel has none
  EXPECT_EQ(RunCommand(Small(out.path(), {"--max-range=-1"})), 2);
  EXPECT_FALSE(fs::exists(out.path()));
}

TEST(Simulate, AFolderThatCannotBeMadeIsNamed) {
  const TemporaryFolder out("simulate_file_in_the_way");
  std::ofstream(out.path()) << "a file";
  const auto written = WriteSimulation({}, {}, out.path() + "/team", [](const auto&) {});
  EXPECT_EQ(written.status().code(), absl::StatusCode::kUnavailable);
  EXPECT_THAT(std::string(written.status().message()), HasSubstr(out.path()));
}

}  // namespace
}  // namespace overtone
