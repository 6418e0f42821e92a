// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/mrclam_recording.h"

#include <cmath>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/robot_plan.h"
#include "overtone/tests/client/cli/recording_files.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

constexpr char kBarcodes[] = "# Subject # Barcode #\n 1 5\n 2 14\n 6 63\n 7 25\n";

// Robot 1 drives 1 m/s ahead for a second, then a quarter circle of radius 1 m to the left.
class MrclamRecording : public ::testing::Test {
 protected:
  MrclamRecording() : folder_("mrclam") {
    folder_.Write("Barcodes.dat", kBarcodes);
    folder_.Write("Robot1_Odometry.dat",
                  "# header\n100.0 1 0\n101.0 1 1.5707963267948966\n102.0 0 0\n103.0 0 0\n");
    folder_.Write("Robot1_Measurement.dat",
                  "100.5 63 2.0 0.5\n100.503 14 3.0 -1.5\n101.5 99 1 0\n101.5 5 1 0\n"
                  "102.0 25 1.0 0\n104 25 1.0 0\n");
    folder_.Write("Robot1_Groundtruth.dat", "99 3 4 3.1\n101 3 4 -3.1\n");
    folder_.Write("Landmark_Groundtruth.dat", "not to be read\n");
  }

  std::string ErrorWith(const std::string& name, const std::string& text) {
    folder_.Write(name, text);
    return std::string(ReadMrclamRecordings(folder_.path()).status().message());
  }

  TemporaryFolder folder_;
};

TEST_F(MrclamRecording, VelocitiesAreIntegratedAlongArcs) {
  const auto recordings = ReadMrclamRecordings(folder_.path());
  ASSERT_TRUE(recordings.ok()) << recordings.status();
  ASSERT_EQ(recordings->size(), 1);
  const Recording& robot = (*recordings)[0];
  EXPECT_EQ(ToString(robot.id), "robot1/run");
  const Rigid3d end = robot.odometry.back().pose;
  const double radius = 2 / M_PI;  // 1 m/s at pi/2 rad/s
  EXPECT_LT((end.translation - Eigen::Vector3d(1 + radius, radius, 0)).norm(), 1e-12);
  EXPECT_LT((LogSO3(end.rotation) - Eigen::Vector3d(0, 0, M_PI / 2)).norm(), 1e-12);
}

TEST_F(MrclamRecording, SightingsSitOnKeyframesOfTheirOwnWithOdometryInBetween) {
  const auto recordings = ReadMrclamRecordings(folder_.path());
  ASSERT_TRUE(recordings.ok()) << recordings.status();
  const Recording& robot = (*recordings)[0];
  // Four odometry rows, and one at 100.5 s and 101.5 s each; 102 s is a row already.
  ASSERT_EQ(robot.odometry.size(), 6);
  EXPECT_EQ(robot.odometry[1].stamp.ns, 100'500'000'000);
  EXPECT_NEAR(robot.odometry[1].pose.translation.x(), 0.5, 1e-12);
  EXPECT_THAT(robot.keyframes, ::testing::ElementsAre(1, 4));

  const auto plan = MakeRobotPlan(robot, {100, 100}, MotionNoise());
  ASSERT_TRUE(plan.ok()) << plan.status();
  ASSERT_EQ(plan->keyframes.size(), 4);  // first, the two, last
  const Observations& seen = plan->observations;
  ASSERT_EQ(seen.landmark_sightings.size(), 2);
  EXPECT_EQ(seen.landmark_sightings[0].landmark, "landmark6");
  EXPECT_EQ(seen.landmark_sightings[0].index, 1);
  EXPECT_EQ(seen.landmark_sightings[1].landmark, "landmark7");
  EXPECT_EQ(seen.landmark_sightings[1].index, 2);
  // 3 ms later than the landmark: the same image.
  ASSERT_EQ(seen.robot_sightings.size(), 1);
  EXPECT_EQ(seen.robot_sightings[0].robot, "robot2");
  EXPECT_EQ(seen.robot_sightings[0].index, 1);
}

TEST_F(MrclamRecording, RangeAndBearingBecomeAPointWithTheirErrorsAlongAndAcrossTheRay) {
  const auto recordings = ReadMrclamRecordings(folder_.path());
  ASSERT_TRUE(recordings.ok()) << recordings.status();
  const LandmarkSighting& sighting = (*recordings)[0].observations.landmark_sightings[0];
  const Eigen::Vector3d ray(std::cos(0.5), std::sin(0.5), 0);
  const Eigen::Vector3d across(-std::sin(0.5), std::cos(0.5), 0);
  EXPECT_LT((sighting.point_in_body - 2 * ray).norm(), 1e-12);
  EXPECT_NEAR(ray.dot(sighting.covariance * ray), std::pow(kMrclamRangeSigma_m, 2), 1e-12);
  EXPECT_NEAR(across.dot(sighting.covariance * across), std::pow(2 * kMrclamBearingSigma_rad, 2),
              1e-12);
  EXPECT_NEAR(ray.dot(sighting.covariance * across), 0, 1e-12);
}

TEST_F(MrclamRecording, WhatNobodyCanUseIsCounted) {
  const auto recordings = ReadMrclamRecordings(folder_.path());
  ASSERT_TRUE(recordings.ok()) << recordings.status();
  // Barcode 99, the robot's own, and one after its odometry ends.
  EXPECT_THAT((*recordings)[0].note, HasSubstr("3 sightings"));
}

TEST_F(MrclamRecording, TheGroundTruthsHeadingWrapsAround) {
  const auto recordings = ReadMrclamRecordings(folder_.path());
  ASSERT_TRUE(recordings.ok()) << recordings.status();
  const auto between = Interpolate((*recordings)[0].ground_truth, Timestamp{100'000'000'000});
  ASSERT_TRUE(between.ok());
  EXPECT_NEAR(std::abs(LogSO3(between->rotation).z()), M_PI, 1e-9);
}

TEST_F(MrclamRecording, ErrorsNameFileAndLine) {
  EXPECT_THAT(ErrorWith("Robot1_Odometry.dat", "1 0 0\n0.5 0 0\n"),
              HasSubstr("Robot1_Odometry.dat:2: the time runs back"));
  EXPECT_THAT(ErrorWith("Robot1_Odometry.dat", "1 0 nan\n"), HasSubstr("Robot1_Odometry.dat:1"));
  EXPECT_THAT(ErrorWith("Robot1_Odometry.dat", "0 1e300 0\n1 1e300 0\n"), HasSubstr("1e+07"));
  EXPECT_THAT(ErrorWith("Robot1_Odometry.dat", "# nothing\n"), HasSubstr("no odometry"));
  folder_.Write("Robot1_Odometry.dat", "0 0 0\n1 0 0\n");
  EXPECT_THAT(ErrorWith("Robot1_Measurement.dat", "1 5\n"),
              HasSubstr("Robot1_Measurement.dat:1: 2 fields where 4 are expected"));
  EXPECT_THAT(ErrorWith("Robot1_Measurement.dat", "1 5 -1 0\n"), HasSubstr("a range of -1 m"));
  EXPECT_THAT(ErrorWith("Barcodes.dat", "1 5\n2 5\n"),
              HasSubstr("Barcodes.dat:2: barcode 5 is given twice"));
  EXPECT_EQ(ReadMrclamRecordings("/nowhere").status().code(), absl::StatusCode::kNotFound);
}

class MrclamData : public ::testing::Test {
 protected:
  void SetUp() override {
    const std::string folder = RealData("mrclam/Dataset6");
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
    auto recordings = ReadMrclamRecordings(folder);
    ASSERT_TRUE(recordings.ok()) << recordings.status();
    recordings_ = *std::move(recordings);
  }

  std::vector<Recording> recordings_;
};

TEST_F(MrclamData, DeadReckoningIsAsFarOffAsPublishedFiguresSay) {
  const double expected_m[] = {2.10, 2.08, 3.05, 1.26, 1.14};
  ASSERT_EQ(recordings_.size(), 5);
  for (int i = 0; i < 5; ++i) {
    // The third figure varies by this with the poses that are compared.
    EXPECT_NEAR(DeadReckonedError(recordings_[i]), expected_m[i], 0.03 * expected_m[i])
        << recordings_[i].name;
  }
}

// Errors of the motion over ten seconds, in standard deviations of the default noise: of the order
// of one in distance and in heading, or the map weighs odometry wrongly.
TEST_F(MrclamData, TheDefaultNoiseFitsTheOdometry) {
  double squares[2] = {0, 0};
  int count = 0;
  for (const Recording& recording : recordings_) {
    const auto plan = MakeRobotPlan(recording, {0.1, 0.1}, DefaultsOf(DatasetKind::kMrclam).noise);
    ASSERT_TRUE(plan.ok()) << plan.status();
    for (size_t begin = 0, end = 1; end < plan->keyframes.size(); ++end) {
      if (plan->TimeOf(end) - plan->TimeOf(begin) < 10) continue;
      if (plan->ground_truth[begin].has_value() && plan->ground_truth[end].has_value()) {
        Matrix6d covariance = Matrix6d::Zero();
        for (size_t i = begin + 1; i <= end; ++i) {
          covariance = CompoundCovariance(covariance,
                                          plan->keyframes[i - 1].mission_from_body.Inverse() *
                                              plan->keyframes[i].mission_from_body,
                                          plan->keyframes[i].motion_covariance);
        }
        const Vector6d error =
            Log((plan->ground_truth[begin]->Inverse() * *plan->ground_truth[end]).Inverse() *
                plan->keyframes[begin].mission_from_body.Inverse() *
                plan->keyframes[end].mission_from_body);
        squares[0] += error.head<2>().squaredNorm() / covariance.topLeftCorner<2, 2>().trace();
        squares[1] += error[5] * error[5] / covariance(5, 5);
        ++count;
      }
      begin = end;
    }
  }
  ASSERT_GT(count, 300);
  for (const double sum : squares) {
    EXPECT_GT(std::sqrt(sum / count), 0.6);
    EXPECT_LT(std::sqrt(sum / count), 1.4);
  }
}

}  // namespace
}  // namespace overtone
