// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/tuc_recording.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/robot_plan.h"
#include "overtone/tests/client/cli/recording_files.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

constexpr char kInput[] =
    "odom2 0 1 0 0 0.01 0.04 0.09\n"
    "odom2 1 0 2 0 0.01 0.04 0.09\n"
    "odom2 3 0 0 0 0.01 0.04 0.09\n"
    "loop 2.9 0.1 0.75\n"
    "loop 1.2 0.1 0.25\n"
    "angle 3 0 0\n";

TEST(TucRecording, VelocitiesInTwoDirectionsAreIntegratedWithTheirVariances) {
  const TemporaryFolder folder("tuc");
  folder.Write("Hall_Input.txt", kInput);
  folder.Write("Hall_GT.txt", "point2 0 5 6 0 0 0 0\npoint2 3 6 7 0 0 0 0\n");
  const auto recording = ReadTucRecording(folder.path(), 0);
  ASSERT_TRUE(recording.ok()) << recording.status();
  EXPECT_EQ(ToString(recording->id), "hall/run");
  ASSERT_EQ(recording->odometry.size(), 3);
  EXPECT_LT((recording->odometry[2].pose.translation - Eigen::Vector3d(1, 4, 0)).norm(), 1e-12);
  // 2 s with 0.1 m/s, 0.2 m/s and 0.3 rad/s.
  const Matrix6d& covariance = recording->motion_covariances[2];
  EXPECT_NEAR(covariance(0, 0), 0.04, 1e-12);
  EXPECT_NEAR(covariance(1, 1), 0.16, 1e-12);
  EXPECT_NEAR(covariance(5, 5), 0.36, 1e-12);
  EXPECT_TRUE(recording->ground_truth_positions_only);
  EXPECT_EQ(recording->ground_truth[1].pose.translation.y(), 7);
}

TEST(TucRecording, CandidatesAreBetweenTheFramesNearestInTime) {
  const TemporaryFolder folder("tuc");
  folder.Write("Hall_Input.txt", kInput);
  const auto all = ReadTucRecording(folder.path(), 0);
  ASSERT_TRUE(all.ok()) << all.status();
  ASSERT_EQ(all->candidates.size(), 2);
  EXPECT_EQ(all->candidates[0].from_frame, 2);
  EXPECT_EQ(all->candidates[0].to_frame, 0);
  EXPECT_EQ(all->candidates[0].score, 0.75);
  EXPECT_EQ(all->candidates[1].from_frame, 1);
  EXPECT_TRUE(all->ground_truth.empty());
  const auto good = ReadTucRecording(folder.path(), 0.5);
  ASSERT_TRUE(good.ok()) << good.status();
  EXPECT_EQ(good->candidates.size(), 1);
}

TEST(TucRecording, ErrorsNameFileAndLine) {
  const TemporaryFolder folder("tuc");
  const auto error_of = [&folder](const std::string& text) {
    folder.Write("Hall_Input.txt", text);
    return std::string(ReadTucRecording(folder.path(), 0).status().message());
  };
  EXPECT_THAT(error_of("odom2 0 1 0\n"), HasSubstr("Hall_Input.txt:1: 4 fields where 8"));
  EXPECT_THAT(error_of("odom2 0 1 0 0 0 1 1\n"), HasSubstr("Hall_Input.txt:1: a variance"));
  EXPECT_THAT(error_of("odom2 1 0 0 0 1 1 1\nodom2 0 0 0 0 1 1 1\n"), HasSubstr(":2: the time"));
  EXPECT_THAT(error_of("loop 0 1 1.5\n"), HasSubstr("Hall_Input.txt:1: a score"));
  EXPECT_THAT(error_of("angle 0 0 0\n"), HasSubstr("no odom2"));
  folder.Write("Other_Input.txt", "");
  EXPECT_THAT(error_of(""), HasSubstr("2 files *_Input.txt"));
}

TEST(TucData, DeadReckoningAndCandidatesAreAsPublishedFiguresSay) {
  const std::string path = RealData("tuc_slam_2d");
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto recording = ReadTucRecording(path, 0);
  ASSERT_TRUE(recording.ok()) << recording.status();
  EXPECT_NEAR(DeadReckonedError(*recording), 12.95, 0.05);
  EXPECT_EQ(recording->candidates.size(), 5180);
  int good = 0, good_and_true = 0;
  for (const FrameCandidate& candidate : recording->candidates) {
    if (candidate.score <= 0.5) continue;
    const auto from =
        Interpolate(recording->ground_truth, recording->odometry[candidate.from_frame].stamp);
    const auto to =
        Interpolate(recording->ground_truth, recording->odometry[candidate.to_frame].stamp);
    ASSERT_TRUE(from.ok() && to.ok());
    ++good;
    good_and_true += (from->translation - to->translation).norm() < 2;
  }
  EXPECT_EQ(good, 1122);
  EXPECT_NEAR(100.0 * good_and_true / good, 91, 1);
}

}  // namespace
}  // namespace overtone
