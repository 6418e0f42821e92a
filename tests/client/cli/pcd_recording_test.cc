// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/pcd_recording.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/drift_injection.h"
#include "overtone/client/cli/robot_plan.h"
#include "overtone/tests/client/cli/recording_files.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

constexpr char kOdometry[] =
    "1 0 0 0 0 1 0 0 0 0 1 0\n"
    "1 0 0 1 0 1 0 0 0 0 1 0\n"
    "0 -1 0 2 1 0 0 0 0 0 1 0\n";
constexpr char kScan[] =
    "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\n"
    "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 1\nDATA ascii\n1 2 3\n";

void WriteRobot(const TemporaryFolder& folder, const std::string& name) {
  folder.Write(name + "/odom_poses.txt", kOdometry);
  folder.Write(name + "/times.txt", "1577836980.0991046\n1577836981\n1577836982\n");
  for (const char* scan : {"000000", "000001", "000002"}) {
    folder.Write(name + "/Scans/" + scan + ".pcd", kScan);
  }
}

TEST(PcdRecording, EveryScanIsAKeyframeAndStaysInItsFile) {
  const TemporaryFolder folder("pcd");
  WriteRobot(folder, "Red");
  const auto recordings = ReadPcdRecordings(folder.path() + "/Red/");
  ASSERT_TRUE(recordings.ok()) << recordings.status();
  ASSERT_EQ(recordings->size(), 1);
  const Recording& robot = (*recordings)[0];
  EXPECT_EQ(robot.name, "Red");
  EXPECT_EQ(ToString(robot.id), "red/run");
  EXPECT_EQ(robot.odometry[0].stamp.ns, 1577836980'099104600);
  EXPECT_TRUE(robot.ground_truth.empty());
  const auto plan = MakeRobotPlan(robot, DefaultsOf(DatasetKind::kPcd).keyframes, MotionNoise());
  ASSERT_TRUE(plan.ok()) << plan.status();
  ASSERT_EQ(plan->observations.clouds.size(), 3);
  const RecordedCloud& cloud = plan->observations.clouds[2];
  EXPECT_EQ(cloud.index, 2);
  EXPECT_EQ(cloud.cloud, nullptr);
  EXPECT_TRUE(std::filesystem::equivalent(cloud.path, folder.path() + "/Red/Scans/000002.pcd"));
}

TEST(PcdRecording, AFolderOfFoldersHoldsSeveralRobotsInOneFrame) {
  const TemporaryFolder folder("pcd");
  WriteRobot(folder, "b");
  WriteRobot(folder, "a");
  folder.Write("a/ground_truth.txt", kOdometry);
  folder.Write("notes/readme.txt", "no robot\n");
  const auto recordings = ReadPcdRecordings(folder.path());
  ASSERT_TRUE(recordings.ok()) << recordings.status();
  ASSERT_EQ(recordings->size(), 2);
  EXPECT_EQ((*recordings)[0].name, "a");
  EXPECT_EQ((*recordings)[0].ground_truth.size(), 3);
  EXPECT_TRUE((*recordings)[0].common_from_world.has_value());
  EXPECT_EQ((*recordings)[1].name, "b");
  EXPECT_FALSE((*recordings)[1].common_from_world.has_value());
}

TEST(PcdRecording, ADegenerateMotionReachesItsKeyframeWithItsDirection) {
  const TemporaryFolder folder("pcd");
  WriteRobot(folder, "a");
  folder.Write("a/degenerate.txt", "# index x y z\n1 2 0 0\n");
  const auto recordings = ReadPcdRecordings(folder.path());
  ASSERT_TRUE(recordings.ok()) << recordings.status();
  const auto every = MakeRobotPlan((*recordings)[0], {0, 0}, MotionNoise());
  ASSERT_TRUE(every.ok());
  EXPECT_FALSE(every->keyframes[0].degenerate);
  EXPECT_TRUE(every->keyframes[1].degenerate);
  EXPECT_LT((every->keyframes[1].degenerate_direction - Eigen::Vector3d(1, 0, 0)).norm(), 1e-12);
  EXPECT_FALSE(every->keyframes[2].degenerate);
  // Row 1 lies on the way to row 2, whose body is turned to the left: ahead is to its right.
  const auto ends = MakeRobotPlan((*recordings)[0], {100, 100}, MotionNoise());
  ASSERT_TRUE(ends.ok());
  ASSERT_EQ(ends->keyframes.size(), 2);
  EXPECT_TRUE(ends->keyframes[1].degenerate);
  EXPECT_LT((ends->keyframes[1].degenerate_direction - Eigen::Vector3d(0, -1, 0)).norm(), 1e-12);
}

TEST(PcdRecording, ErrorsNameFileAndLine) {
  const TemporaryFolder folder("pcd");
  const auto error_of = [&folder](const std::string& name, const std::string& text) {
    WriteRobot(folder, "a");
    folder.Write(name, text);
    return std::string(ReadPcdRecordings(folder.path()).status().message());
  };
  EXPECT_EQ(error_of("a/readme", ""), "");
  EXPECT_THAT(error_of("a/times.txt", "1\n2\n"), HasSubstr("3 poses for 2 rows"));
  EXPECT_THAT(error_of("a/times.txt", "1\n1\n2\n"), HasSubstr("times.txt:2: the time does not"));
  EXPECT_THAT(error_of("a/odom_poses.txt", "1 2 3\n"), HasSubstr("odom_poses.txt:1"));
  EXPECT_THAT(error_of("a/degenerate.txt", "3 0 0 1\n"),
              HasSubstr("degenerate.txt:1: there is no"));
  EXPECT_THAT(error_of("a/degenerate.txt", "1 0 x 1\n"), HasSubstr("degenerate.txt:1"));
  std::filesystem::remove(folder.path() + "/a/degenerate.txt");
  std::filesystem::remove(folder.path() + "/a/Scans/000001.pcd");
  const auto missing = ReadPcdRecordings(folder.path());
  EXPECT_EQ(missing.status().code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(missing.status().message()), HasSubstr("000001.pcd"));
  EXPECT_EQ(ReadPcdRecordings("/nowhere").status().code(), absl::StatusCode::kNotFound);
}

TEST(PcdData, ARealRunIsReadWithoutItsPoints) {
  const std::string path = RealData("hku_livox");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto recordings = ReadPcdRecordings(path);
  ASSERT_TRUE(recordings.ok()) << recordings.status();
  ASSERT_EQ(recordings->size(), 1);
  EXPECT_EQ((*recordings)[0].observations.clouds.size(), 314);
  EXPECT_NEAR(PathLength((*recordings)[0].odometry), 63.6, 0.1);
}

}  // namespace
}  // namespace overtone
