// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/geometry/trajectory_error.h"

#include <cmath>

#include "gtest/gtest.h"
#include "overtone/tests/core/geometry/random_poses.h"

namespace overtone {
namespace {

Rigid3d At(double x, double y, double z) {
  return Rigid3d(Eigen::Quaterniond::Identity(), {x, y, z});
}

// A square whose corners the estimate has pushed outwards along x and inwards along y: the symmetry
// keeps the best alignment at the identity, so every error is known by hand.
TEST(AbsoluteTrajectoryError, MatchesAHandComputedCase) {
  const std::vector<Rigid3d> reference = {At(2, 0, 0), At(-2, 0, 0), At(0, 2, 0), At(0, -2, 0),
                                          At(0, 0, 0)};
  const std::vector<Rigid3d> estimate = {At(2.3, 0, 0), At(-2.3, 0, 0), At(0, 1.9, 0),
                                         At(0, -1.9, 0), At(0, 0, 0)};
  const auto error = AbsoluteTrajectoryError(estimate, reference);
  ASSERT_TRUE(error.ok()) << error.status();
  EXPECT_NEAR(error->rmse_m, std::sqrt(2 * (0.09 + 0.01) / 5), 1e-12);
  EXPECT_NEAR(error->mean_m, (0.3 + 0.3 + 0.1 + 0.1) / 5, 1e-12);
  EXPECT_NEAR(error->median_m, 0.1, 1e-12);
  EXPECT_NEAR(error->max_m, 0.3, 1e-12);
  EXPECT_NEAR(error->rotation_rmse_rad, 0, 1e-12);
  ASSERT_EQ(error->per_pose_m.size(), 5u);
  EXPECT_NEAR(error->per_pose_m[2], 0.1, 1e-12);
}

TEST(AbsoluteTrajectoryError, MedianOfAnEvenNumberIsTheMeanOfTheMiddleTwo) {
  const std::vector<Rigid3d> reference = {At(2, 0, 0), At(-2, 0, 0), At(0, 2, 0), At(0, -2, 0)};
  const std::vector<Rigid3d> estimate = {At(2.3, 0, 0), At(-2.3, 0, 0), At(0, 1.9, 0),
                                         At(0, -1.9, 0)};
  EXPECT_NEAR(AbsoluteTrajectoryError(estimate, reference)->median_m, 0.2, 1e-12);
}

TEST(AbsoluteTrajectoryError, DoesNotSeeTheFrameOfTheEstimate) {
  RandomPoses random(1);
  const std::vector<Rigid3d> reference = random.Walk(50, 1);
  std::vector<Rigid3d> estimate;
  for (const Rigid3d& pose : reference) estimate.push_back(pose * Exp(random.Tangent(0.1, 0.05)));
  const auto error = AbsoluteTrajectoryError(estimate, reference);
  ASSERT_TRUE(error.ok()) << error.status();
  EXPECT_NEAR(error->rotation_rmse_rad, 0.05, 0.02);

  const Rigid3d elsewhere = random.Pose(100);
  for (Rigid3d& pose : estimate) pose = elsewhere * pose;
  const auto moved = AbsoluteTrajectoryError(estimate, reference);
  ASSERT_TRUE(moved.ok()) << moved.status();
  EXPECT_NEAR(moved->rmse_m, error->rmse_m, 1e-12);
  EXPECT_NEAR(moved->rotation_rmse_rad, error->rotation_rmse_rad, 1e-12);
}

TEST(AbsoluteTrajectoryError, YawOnlySeesTiltAndFullDoesNot) {
  RandomPoses random(2);
  const std::vector<Rigid3d> reference = random.Walk(50, 1);
  std::vector<Rigid3d> tilted;
  for (const Rigid3d& pose : reference)
    tilted.push_back(Rigid3d(ExpSO3({0.2, 0, 0}), {1, 2, 3}) * pose);
  EXPECT_LT(AbsoluteTrajectoryError(tilted, reference, AlignmentMode::kSe3)->rmse_m, 1e-12);
  EXPECT_GT(AbsoluteTrajectoryError(tilted, reference, AlignmentMode::kYawOnly)->rmse_m, 0.05);
}

TEST(RelativePoseError, MatchesAHandComputedCase) {
  // Straight ahead by 1 m a step; the estimate makes 1.1 m of it and turns by 0.02 rad to the left
  // in each.
  std::vector<Rigid3d> reference(1), estimate(1);
  const Rigid3d step = At(1, 0, 0), drifting(ExpSO3({0, 0, 0.02}), {1.1, 0, 0});
  for (int i = 0; i < 10; ++i) {
    reference.push_back(reference.back() * step);
    estimate.push_back(estimate.back() * drifting);
  }
  const auto one = RelativePoseError(estimate, reference, 1);
  ASSERT_TRUE(one.ok()) << one.status();
  ASSERT_EQ(one->per_pair_m.size(), 10u);
  EXPECT_NEAR(one->translation_rmse_m, 0.1, 1e-12);
  EXPECT_NEAR(one->rotation_rmse_rad, 0.02, 1e-12);
  EXPECT_NEAR(one->yaw_rmse_rad, 0.02, 1e-12);
  // Over two steps: 1.1 (1 + cos 0.02, sin 0.02) instead of (2, 0), and 0.04 rad.
  const auto two = RelativePoseError(estimate, reference, 2);
  ASSERT_TRUE(two.ok()) << two.status();
  ASSERT_EQ(two->per_pair_m.size(), 9u);
  EXPECT_NEAR(two->translation_rmse_m,
              std::hypot(1.1 * (1 + std::cos(0.02)) - 2, 1.1 * std::sin(0.02)), 1e-12);
  EXPECT_NEAR(two->rotation_rmse_rad, 0.04, 1e-12);
}

TEST(RelativePoseError, YawIsAboutTheWorldsVerticalNotTheBodys) {
  // The body's x axis points up: drift about it is yaw, drift about the body's z axis is not.
  const Eigen::Quaterniond x_up = ExpSO3({0, -0.5 * 3.14159265358979323846, 0});
  const std::vector<Rigid3d> reference(2, Rigid3d(x_up, {0, 0, 0}));
  std::vector<Rigid3d> estimate = reference;
  estimate[1].rotation = x_up * ExpSO3({0.03, 0, 0});
  EXPECT_NEAR(RelativePoseError(estimate, reference, 1)->yaw_rmse_rad, 0.03, 1e-12);
  estimate[1].rotation = x_up * ExpSO3({0, 0, 0.03});
  EXPECT_NEAR(RelativePoseError(estimate, reference, 1)->yaw_rmse_rad, 0, 1e-12);
  EXPECT_NEAR(RelativePoseError(estimate, reference, 1)->rotation_rmse_rad, 0.03, 1e-12);
}

TEST(RelativePoseError, DoesNotSeeTheFramesOfEither) {
  RandomPoses random(3);
  std::vector<Rigid3d> reference = random.Walk(30, 1), estimate = random.Walk(30, 1);
  const double before = RelativePoseError(estimate, reference, 3)->translation_rmse_m;
  const Rigid3d a = random.Pose(100), b = random.Pose(100);
  for (Rigid3d& pose : reference) pose = a * pose;
  for (Rigid3d& pose : estimate) pose = b * pose;
  EXPECT_NEAR(RelativePoseError(estimate, reference, 3)->translation_rmse_m, before, 1e-11);
}

TEST(TrajectoryErrors, RefuseUnequalLengthsAndTooFewPoses) {
  const std::vector<Rigid3d> three = {At(0, 0, 0), At(1, 0, 0), At(0, 1, 0)},
                             two = {three[0], three[1]};
  const auto code = absl::StatusCode::kInvalidArgument;
  EXPECT_EQ(AbsoluteTrajectoryError(three, two).status().code(), code);
  EXPECT_EQ(AbsoluteTrajectoryError({}, {}).status().code(), code);
  EXPECT_EQ(AbsoluteTrajectoryError(two, two).status().code(), code);
  EXPECT_EQ(RelativePoseError(three, two, 1).status().code(), code);
  EXPECT_EQ(RelativePoseError({}, {}, 1).status().code(), code);
  for (const int delta : {-1, 0, 3, 1 << 30}) {
    EXPECT_EQ(RelativePoseError(three, three, delta).status().code(), code) << delta;
  }
}

}  // namespace
}  // namespace overtone
