// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/position_noise.h"

#include <random>

#include "gtest/gtest.h"
#include "overtone/core/synchronization/aligned_rmse.h"
#include "overtone/tests/support/drifting_mission.h"

namespace overtone {
namespace {

// Server and robot agree but for noise of 2 cm for each axis; the robot's frame is another.
TrajectoryComparison Noisy(int seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, 0.02);
  TrajectoryComparison comparison = ComparisonOf(MakeDriftingMission(300, seed));
  comparison.onboard = comparison.server;
  const Rigid3d other(ExpSO3({0.5, 1, -2}), Eigen::Vector3d(100, 7, 3));
  for (Rigid3d& pose : comparison.onboard) {
    for (double& entry : pose.translation) entry += normal(random);
    pose = other * pose;
  }
  return comparison;
}

TEST(PositionNoise, IsTheRmseOfNoiseWhateverTheFrames) {
  for (int seed = 1; seed <= 10; ++seed) {
    const TrajectoryComparison comparison = Noisy(seed);
    const double rmse = AlignedRmse(comparison.onboard, comparison.server);
    EXPECT_NEAR(PositionNoise(comparison), std::sqrt(3) * 0.02, 0.006) << "seed " << seed;
    EXPECT_LT(rmse, 1.5 * PositionNoise(comparison)) << "seed " << seed;
  }
}

TEST(PositionNoise, DriftIsNoneOfItInWhateverDirection) {
  for (const Eigen::Vector3d& direction : {Eigen::Vector3d::UnitX(), Eigen::Vector3d::UnitZ()}) {
    TrajectoryComparison comparison = Noisy(1);
    const double without = PositionNoise(comparison);
    for (int i = 150; i < 300; ++i)
      comparison.onboard[i].translation += 0.002 * (i - 150) * direction;
    EXPECT_NEAR(PositionNoise(comparison), without, 0.1 * without);
    EXPECT_GT(AlignedRmse(comparison.onboard, comparison.server), 2 * without);
  }
}

TEST(PositionNoise, TwoNodesHaveNone) {
  TrajectoryComparison comparison;
  comparison.server = comparison.onboard = {Rigid3d(), Rigid3d()};
  EXPECT_EQ(PositionNoise(comparison), 0);
}

}  // namespace
}  // namespace overtone
