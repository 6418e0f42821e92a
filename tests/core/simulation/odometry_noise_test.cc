// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/odometry_noise.h"

#include <cmath>
#include <limits>

#include "gtest/gtest.h"
#include "overtone/core/simulation/random.h"

namespace overtone {
namespace {

const OdometryNoise kNone = {0, 0, 0, 0, 0};

// Straight on at 1 m/s, ten poses a second.
Trajectory StraightLine(int num_poses) {
  Trajectory line;
  for (int i = 0; i < num_poses; ++i) {
    line.push_back(
        {Timestamp{i * 100'000'000LL}, Rigid3d(Eigen::Quaterniond::Identity(), {0.1 * i, 0, 0})});
  }
  return line;
}

double Yaw(const Rigid3d& pose) { return LogSO3(pose.rotation).z(); }

TEST(OdometryNoise, WithoutNoiseOdometryIsTheTruthSeenFromItsFirstPose) {
  Trajectory truth;
  Random random(3);
  Rigid3d pose(ExpSO3(random.Normal3()), random.Normal3());
  for (int i = 0; i < 100; ++i) {
    truth.push_back({Timestamp{i * 100'000'000LL}, pose});
    pose = pose * Rigid3d(ExpSO3(0.1 * random.Normal3()), random.Normal3());
  }
  const Trajectory odometry = SimulateOdometry(truth, kNone, /*seed=*/1);
  ASSERT_EQ(odometry.size(), truth.size());
  for (size_t i = 0; i < truth.size(); ++i) {
    EXPECT_EQ(odometry[i].stamp, truth[i].stamp);
    EXPECT_LT(Log(odometry[i].pose.Inverse() * (truth[0].pose.Inverse() * truth[i].pose)).norm(),
              1e-9);
  }
}

// Over steps of 0.1 s a density d gives d * sqrt(0.1).
TEST(OdometryNoise, WhiteNoiseHasTheStatedDensity) {
  OdometryNoise noise = kNone;
  noise.translation_density = 0.02;
  noise.rotation_density = 0.003;
  const int num_steps = 50'000;
  const Trajectory truth = StraightLine(num_steps + 1);
  const Trajectory odometry = SimulateOdometry(truth, noise, /*seed=*/2);
  Vector6d sum_of_squares = Vector6d::Zero();
  for (int i = 1; i <= num_steps; ++i) {
    const Rigid3d true_motion = truth[i - 1].pose.Inverse() * truth[i].pose;
    const Rigid3d motion = odometry[i - 1].pose.Inverse() * odometry[i].pose;
    sum_of_squares += Log(true_motion.Inverse() * motion).cwiseAbs2();
  }
  const Vector6d sigma = (sum_of_squares / num_steps).cwiseSqrt();
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(sigma[i], 0.02 * std::sqrt(0.1), 0.02 * std::sqrt(0.1) * 0.016);  // 5 sigma
    EXPECT_NEAR(sigma[i + 3], 0.003 * std::sqrt(0.1), 0.003 * std::sqrt(0.1) * 0.016);
  }
}

TEST(OdometryNoise, ScaleErrorStretchesThePathAndHasTheStatedSigma) {
  OdometryNoise noise = kNone;
  noise.scale_sigma = 0.05;
  const Trajectory truth = StraightLine(101);
  double sum_of_squares = 0;
  const int num_seeds = 4000;
  for (int seed = 0; seed < num_seeds; ++seed) {
    const Trajectory odometry = SimulateOdometry(truth, noise, seed);
    const double scale = odometry.back().pose.translation.x() / 10;
    EXPECT_NEAR(PathLength(odometry), 10 * scale, 1e-9);
    sum_of_squares += (scale - 1) * (scale - 1);
  }
  EXPECT_NEAR(std::sqrt(sum_of_squares / num_seeds), 0.05, 0.0028);  // five standard errors
}

TEST(OdometryNoise, AConstantBiasTurnsTheHeadingInProportionToTime) {
  OdometryNoise noise = kNone;
  noise.initial_yaw_bias_sigma = 0.01;
  const Trajectory odometry = SimulateOdometry(StraightLine(201), noise, /*seed=*/5);
  EXPECT_GT(std::abs(Yaw(odometry[200].pose)), 1e-4);
  EXPECT_NEAR(Yaw(odometry[200].pose), 2 * Yaw(odometry[100].pose), 1e-9);
  EXPECT_NEAR(odometry[200].pose.translation.z(), 0, 1e-12);  // no other axis
}

// The integral of a random walk: the variance grows with the third power of time, so the error at
// four times the time is eight times as large.
TEST(OdometryNoise, AWalkingBiasMakesYawErrorGrowWithTimeToThePowerThreeHalves) {
  OdometryNoise noise = kNone;
  noise.yaw_bias_walk_density = 1e-3;
  const Trajectory truth = StraightLine(401);
  double early = 0, late = 0;
  for (uint64_t seed = 0; seed < 1000; ++seed) {
    const Trajectory odometry = SimulateOdometry(truth, noise, seed);
    early += std::pow(Yaw(odometry[100].pose), 2);
    late += std::pow(Yaw(odometry[400].pose), 2);
  }
  EXPECT_NEAR(std::sqrt(late / early), 8, 0.9);
  // 1e-3 * sqrt(40^3 / 3)
  EXPECT_NEAR(std::sqrt(late / 1000), 0.146, 0.017);
}

TEST(OdometryNoise, PositionDriftGrowsAlongThePath) {
  const Trajectory truth = StraightLine(4001);
  double early = 0, late = 0;
  for (uint64_t seed = 0; seed < 50; ++seed) {
    const Trajectory odometry = SimulateOdometry(truth, OdometryNoise(), seed);
    early += (odometry[500].pose.translation - truth[500].pose.translation).squaredNorm();
    late += (odometry[4000].pose.translation - truth[4000].pose.translation).squaredNorm();
  }
  EXPECT_GT(std::sqrt(late), 4 * std::sqrt(early));
}

TEST(OdometryNoise, NoTruthGivesNoOdometry) {
  EXPECT_TRUE(SimulateOdometry({}, OdometryNoise(), 1).empty());
}

TEST(OdometryNoise, DefaultsAreValidAndBadMembersAreNamed) {
  EXPECT_TRUE(OdometryNoise().Validate().ok());
  OdometryNoise noise;
  noise.scale_sigma = -1;
  EXPECT_EQ(noise.Validate().message(),
            "OdometryNoise.scale_sigma: must be finite and not negative, is -1");
  noise = OdometryNoise();
  noise.rotation_density = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(noise.Validate().code(), absl::StatusCode::kInvalidArgument);
}

}  // namespace
}  // namespace overtone
