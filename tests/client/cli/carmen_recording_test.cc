// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/carmen_recording.h"

#include <cmath>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/robot_plan.h"
#include "overtone/tests/client/cli/recording_files.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

// Four beams: at -90, -45, 0 and 45 degrees. 80 is no return.
constexpr char kLog[] =
    "# a comment\n"
    "PARAM robot_use_laser on nohost 0\n"
    "ODOM 0 0 0 0 0 0 10.5 nohost 0\n"
    "FLASER 4 1 80 2 0 9 9 9 1 0 0 10.5 host 0.1\n"
    "FLASER 4 1 80 3 80 9 9 9 2 0 0 10.7 host 0.3\n"
    "FLASER 4 1 80 4 80 9 9 9 3 0 1.5707963267948966 10.6 host 0.2\n";

TEST(CarmenRecording, BeamsBecomePointsAndWhatDoesNotReturnIsLeftOut) {
  const TemporaryFolder folder("carmen");
  const auto recording = ReadCarmenRecording(folder.Write("lab.clf", kLog), "", "");
  ASSERT_TRUE(recording.ok()) << recording.status();
  EXPECT_EQ(ToString(recording->id), "lab/run");
  ASSERT_EQ(recording->observations.clouds.size(), 3);
  const auto& points = recording->observations.clouds[0].cloud->points;
  ASSERT_EQ(points.size(), 2);
  EXPECT_LT((points[0] - Eigen::Vector3f(0, -1, 0)).norm(), 1e-6);  // to the right
  EXPECT_LT((points[1] - Eigen::Vector3f(2, 0, 0)).norm(), 1e-6);   // ahead
}

TEST(CarmenRecording, OdometryIsTheLogsInItsOrderEvenWhereTheClockRunsBack) {
  const TemporaryFolder folder("carmen");
  const auto recording = ReadCarmenRecording(folder.Write("lab.clf", kLog), "", "");
  ASSERT_TRUE(recording.ok()) << recording.status();
  ASSERT_EQ(recording->odometry.size(), 3);
  EXPECT_EQ(recording->odometry[0].pose.translation.norm(), 0);
  EXPECT_NEAR(recording->odometry[2].pose.translation.x(), 2, 1e-12);
  EXPECT_NEAR(LogSO3(recording->odometry[2].pose.rotation).z(), M_PI / 2, 1e-12);
  EXPECT_EQ(recording->odometry[1].stamp.ns, 10'700'000'000);
  EXPECT_EQ(recording->odometry[2].stamp.ns, 10'700'001'000);
}

TEST(CarmenRecording, CorrectedPosesAreFoundByTheirRangesAndBecomeKeyframes) {
  const TemporaryFolder folder("carmen");
  const std::string log = folder.Write("lab.clf", kLog);
  const std::string reference = folder.Write("lab-corrected.log",
                                             "FLASER 4 1 80 3.00 80 7 8 0.5 7 8 0.5 0.3 host 0.3\n"
                                             "FLASER 4 1 80 5 80 7 8 0.5 7 8 0.5 0.4 host 0.4\n");
  const auto recording = ReadCarmenRecording(log, reference, "");
  ASSERT_TRUE(recording.ok()) << recording.status();
  ASSERT_EQ(recording->ground_truth.size(), 1);
  EXPECT_EQ(recording->ground_truth[0].stamp, recording->odometry[1].stamp);
  EXPECT_EQ(recording->ground_truth[0].pose.translation.x(), 7);
  EXPECT_THAT(recording->keyframes, ::testing::ElementsAre(1));
  const std::string other = folder.Write("other.log", "FLASER 1 5 0 0 0 0 0 0 1 host 1\n");
  EXPECT_THAT(std::string(ReadCarmenRecording(log, other, "").status().message()),
              HasSubstr("none of its scans"));
}

TEST(CarmenRecording, RelationsAreBetweenKeyframesByTheirTime) {
  const TemporaryFolder folder("carmen");
  const std::string log = folder.Write("lab.clf", kLog);
  const std::string relations =
      folder.Write("lab.relations", "10.500000 10.6 1 2 0 0 0 1.5707963267948966\n");
  const auto recording = ReadCarmenRecording(log, "", relations);
  ASSERT_TRUE(recording.ok()) << recording.status();
  ASSERT_EQ(recording->relations.size(), 1);
  EXPECT_EQ(recording->relations[0].from_frame, 0);
  EXPECT_EQ(recording->relations[0].to_frame, 2);
  EXPECT_LT(
      (recording->relations[0].from_tform_to * Eigen::Vector3d(1, 0, 0) - Eigen::Vector3d(1, 3, 0))
          .norm(),
      1e-12);
  EXPECT_THAT(recording->keyframes, ::testing::ElementsAre(0, 2));
  const std::string bad = folder.Write("bad.relations", "10.5 99 0 0 0 0 0 0\n");
  EXPECT_THAT(std::string(ReadCarmenRecording(log, "", bad).status().message()),
              HasSubstr("bad.relations:1: the log has no scan at 99 s"));
}

TEST(CarmenRecording, ErrorsNameFileAndLine) {
  const TemporaryFolder folder("carmen");
  const auto error_of = [&folder](const std::string& text) {
    return std::string(
        ReadCarmenRecording(folder.Write("bad.clf", text), "", "").status().message());
  };
  EXPECT_THAT(error_of("FLASER\n"), HasSubstr("bad.clf:1"));
  EXPECT_THAT(error_of("FLASER 1000000000 1\n"), HasSubstr("a scan of 1000000000 beams"));
  EXPECT_THAT(error_of("FLASER 2 1 0 0 0 0 0 0 1 host 1\n"),
              HasSubstr("bad.clf:1: 12 fields where 13"));
  EXPECT_THAT(error_of("FLASER 1 nan 0 0 0 0 0 0 1 host 1\n"), HasSubstr("bad.clf:1"));
  EXPECT_THAT(error_of("FLASER 1 1 0 0 0 1e9 0 0 1 host 1\n"), HasSubstr("bad.clf:1"));
  EXPECT_THAT(error_of("ODOM 0 0 0 0 0 0 1 host 1\n"), HasSubstr("no FLASER lines"));
}

struct RealLog {
  std::string name;
  int reference_scans;
  int relations;
  double error_m;
};

class CarmenData : public ::testing::TestWithParam<RealLog> {};

TEST_P(CarmenData, RawOdometryIsAsFarOffAsPublishedFiguresSay) {
  const std::string prefix = RealData("radish_2d/" + GetParam().name);
  if (!std::filesystem::exists(prefix + ".clf")) GTEST_SKIP() << prefix << ".clf is not there";
  const auto recording = ReadCarmenRecording(prefix + ".clf", prefix + "-corrected.log",
                                             GetParam().relations > 0 ? prefix + ".relations" : "");
  ASSERT_TRUE(recording.ok()) << recording.status();
  EXPECT_EQ(recording->ground_truth.size(), GetParam().reference_scans);
  EXPECT_EQ(recording->relations.size(), GetParam().relations);
  // The figure depends on which poses are compared; the last digit of it is not known.
  EXPECT_NEAR(DeadReckonedError(*recording), GetParam().error_m, 0.03 * GetParam().error_m);
}

INSTANTIATE_TEST_SUITE_P(Logs, CarmenData,
                         ::testing::Values(RealLog{"intel", 910, 0, 24.0},
                                           RealLog{"aces", 440, 1279, 5.4}),
                         [](const auto& info) { return info.param.name; });

}  // namespace
}  // namespace overtone
