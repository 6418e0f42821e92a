// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/load_recordings.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/replay_input.h"
#include "overtone/tests/client/cli/recording_files.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

Recording StraightRun(int poses) {
  Recording recording;
  for (int i = 0; i < poses; ++i) {
    recording.odometry.push_back(
        {Timestamp{i}, Rigid3d(Eigen::Quaterniond::Identity(), {0.5 * i, 0, 0})});
    recording.frames.push_back(i);
  }
  return recording;
}

TEST(DriftInjection, StepsAreDisturbedAsStatedAndByTheSeed) {
  const Recording original = StraightRun(20001);
  Recording drifted = original, again = original, other = original;
  const DriftInjection drift = {0.1, 0.02, 7};
  InjectDrift(drift, 0, &drifted);
  InjectDrift(drift, 0, &again);
  InjectDrift(drift, 1, &other);
  double translation = 0, rotation = 0;
  for (int i = 1; i <= 20000; ++i) {
    const Rigid3d step = drifted.odometry[i - 1].pose.Inverse() * drifted.odometry[i].pose;
    const Vector6d error =
        Log(Rigid3d(Eigen::Quaterniond::Identity(), {0.5, 0, 0}).Inverse() * step);
    translation += error.head<3>().squaredNorm() / 3 / 20000;
    rotation += error.tail<3>().squaredNorm() / 3 / 20000;
  }
  EXPECT_NEAR(std::sqrt(translation), 0.1 * std::sqrt(0.5), 0.001);
  EXPECT_NEAR(std::sqrt(rotation), 0.02 * std::sqrt(0.5), 0.0002);
  EXPECT_EQ(again.odometry.back().pose.translation, drifted.odometry.back().pose.translation);
  EXPECT_NE(other.odometry.back().pose.translation, drifted.odometry.back().pose.translation);
}

TEST(DriftInjection, IsReadFromText) {
  EXPECT_EQ(ParseDriftInjection("translation=0.1,seed=3")->seed, 3);
  EXPECT_FALSE(ParseDriftInjection("seed=3").ok());
  EXPECT_FALSE(ParseDriftInjection("translation=-1").ok());
  EXPECT_FALSE(ParseDriftInjection("rotation=0.1,seed=-1").ok());
}

// A folder in the form of `pcd`: `poses` poses along x, half a metre apart.
void WriteRobot(const TemporaryFolder& folder, const std::string& name, int poses) {
  std::string odometry, times;
  for (int i = 0; i < poses; ++i) {
    absl::StrAppend(&odometry, "1 0 0 ", 0.5 * i, " 0 1 0 0 0 0 1 0\n");
    absl::StrAppend(&times, 100 + i, "\n");
    char scan[32];
    snprintf(scan, sizeof(scan), "/Scans/%06d.pcd", i);
    folder.Write(name + scan, "");
  }
  folder.Write(name + "/odom_poses.txt", odometry);
  folder.Write(name + "/times.txt", times);
}

ReplayOptions PcdOptions(const std::vector<std::string>& paths) {
  ReplayOptions options;
  options.dataset = DatasetKind::kPcd;
  options.dataset_name = "pcd";
  options.sensor_files.paths = paths;
  return options;
}

TEST(LoadRecordings, PartsOfARunDriftEachItsOwnWayFromTheOneTruth) {
  const TemporaryFolder folder("load");
  WriteRobot(folder, "run", 40);
  ReplayOptions options = PcdOptions({folder.path() + "/run"});
  options.split = 2;
  options.overlap = 0;
  options.inject_drift = "translation=0.1,rotation=0.01";
  const auto loaded = LoadRecordings(options);
  ASSERT_TRUE(loaded.ok()) << loaded.status();
  ASSERT_EQ(loaded->recordings.size(), 2);
  Rigid3d motions[2];
  for (int i = 0; i < 2; ++i) {
    const Recording& part = loaded->recordings[i];
    EXPECT_EQ(part.odometry[0].pose.translation.norm(), 0);
    EXPECT_TRUE(part.common_from_world.has_value());
    EXPECT_NEAR(Interpolate(part.ground_truth, part.odometry[0].stamp)->translation.x(), 10 * i,
                1e-12);
    motions[i] = part.odometry[1].pose;
  }
  EXPECT_GT((motions[0].translation - motions[1].translation).norm(), 1e-6);

  const auto input = MakeReplayInput(options);
  ASSERT_TRUE(input.ok()) << input.status();
  ASSERT_EQ(input->plans[1].observations.clouds.size(), 20);
  EXPECT_EQ(input->plans[1].observations.clouds[0].index, 0);
  EXPECT_THAT(input->plans[1].observations.clouds[0].path, HasSubstr("000020.pcd"));
  EXPECT_THAT(input->closures_note, HasSubstr("Drift was INJECTED"));
  EXPECT_THAT(input->closures_note, HasSubstr("40 point clouds"));
  // Trusted as far as it now deserves: half a metre at 0.1 m after 1 m, at least.
  EXPECT_GT(input->plans[0].keyframes[1].motion_covariance(0, 0), 0.1 * 0.1 * 0.4);
}

TEST(LoadRecordings, SeveralFoldersAreSeveralRobots) {
  const TemporaryFolder folder("load");
  WriteRobot(folder, "x/red", 10);
  WriteRobot(folder, "y/red", 10);
  WriteRobot(folder, "y/green", 10);
  const auto two = LoadRecordings(PcdOptions({folder.path() + "/x", folder.path() + "/y/green"}));
  ASSERT_TRUE(two.ok()) << two.status();
  EXPECT_EQ(two->recordings.size(), 2);
  const auto twice = LoadRecordings(PcdOptions({folder.path() + "/x", folder.path() + "/y"}));
  EXPECT_THAT(std::string(twice.status().message()),
              HasSubstr("--dataset pcd: " + folder.path() + "/y: a second robot named red"));
  EXPECT_THAT(std::string(LoadRecordings(PcdOptions({})).status().message()),
              HasSubstr("needs the path"));
}

TEST(ReplayInput, ACandidateBelongsToTheRobotThatReachesItLater) {
  const TemporaryFolder folder("load");
  std::string text;
  for (int i = 0; i < 40; ++i) absl::StrAppend(&text, "odom2 ", i, " 1 0 0 0.01 0.01 0.01\n");
  // Two views that fall on one pair of keyframes count once, with their better score.
  absl::StrAppend(&text, "loop 12 2 0.5\nloop 12.1 2 0.75\nloop 3 3 1\n");
  folder.Write("hall_Input.txt", text);
  ReplayOptions options;
  options.dataset = DatasetKind::kTuc;
  options.dataset_name = "tuc";
  options.sensor_files.paths = {folder.path()};
  const auto input = MakeReplayInput(options);
  ASSERT_TRUE(input.ok()) << input.status();
  const std::vector<RobotRecording> recordings = MakeRecordings(*input);
  ASSERT_EQ(recordings.size(), 1);
  ASSERT_EQ(recordings[0].candidates.size(), 1);
  EXPECT_EQ(recordings[0].candidates[0].from.index, 12);
  EXPECT_EQ(recordings[0].candidates[0].to.index, 2);
  EXPECT_EQ(recordings[0].candidates[0].score, 0.75);

  // Cut in two, the later end is in the second part, at an earlier time since its own start.
  options.split = 2;
  options.overlap = 0;
  folder.Write("hall_Input.txt", text + "loop 22 10 0.5\n");
  const auto parts = MakeReplayInput(options);
  ASSERT_TRUE(parts.ok()) << parts.status();
  const std::vector<RobotRecording> two = MakeRecordings(*parts);
  ASSERT_EQ(two.size(), 2);
  EXPECT_EQ(two[0].candidates.size(), 2);  // 10 s since its start is later than 2 s
  EXPECT_EQ(two[1].candidates.size(), 0);
}

}  // namespace
}  // namespace overtone
