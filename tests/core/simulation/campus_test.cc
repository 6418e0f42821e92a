// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/campus.h"

#include "gtest/gtest.h"

namespace overtone {
namespace {

TEST(Campus, SlopeIsTheDerivativeOfHeight) {
  const double h = 1e-6;
  for (const Eigen::Vector2d& p :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(12, 31), Eigen::Vector2d(44, 3)}) {
    const Eigen::Vector2d x(h, 0), y(0, h);
    EXPECT_NEAR(Campus::Slope(p).x(), (Campus::Height(p + x) - Campus::Height(p - x)) / (2 * h),
                1e-8);
    EXPECT_NEAR(Campus::Slope(p).y(), (Campus::Height(p + y) - Campus::Height(p - y)) / (2 * h),
                1e-8);
  }
}

TEST(Campus, ARobotStandsOnTheGroundAndLooksWhereItGoes) {
  const Eigen::Vector2d position(12, 31), heading(-2, 1);
  const Rigid3d map_from_body = Campus::PoseOnGround(position, heading);
  EXPECT_NEAR(map_from_body.translation.z(), Campus::Height(position), 1e-12);
  const Eigen::Vector3d forward = map_from_body.rotation * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(forward.head<2>().normalized().dot(heading.normalized()), 1, 1e-12);
  EXPECT_NEAR(forward.z() / forward.head<2>().norm(),
              Campus::Slope(position).dot(heading.normalized()), 1e-12);
  EXPECT_GT((map_from_body.rotation * Eigen::Vector3d::UnitZ()).z(), 0.9);  // upright
}

TEST(Campus, AWalkFollowsTheStreetsAndNeverTurnsBack) {
  for (uint64_t seed = 0; seed < 50; ++seed) {
    Random random(seed);
    const std::vector<Eigen::Vector2d> walk = Campus::RandomWalk(40, random);
    ASSERT_EQ(walk.size(), 40u * Campus::kPointsPerStreet + 1);
    const double side_m = (Campus::kJunctionsPerSide - 1) * Campus::kBlockM;
    for (size_t i = 0; i < walk.size(); ++i) {
      EXPECT_TRUE(walk[i].minCoeff() >= 0 && walk[i].maxCoeff() <= side_m) << walk[i];
      if (i == 0) continue;
      EXPECT_NEAR((walk[i] - walk[i - 1]).norm(), Campus::kBlockM / Campus::kPointsPerStreet, 1e-9);
      if (i > 1) {
        EXPECT_GT((walk[i] - walk[i - 2]).norm(), 1) << "seed " << seed;
      }
    }
  }
}

}  // namespace
}  // namespace overtone
