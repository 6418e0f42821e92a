// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/obstacle.h"

#include <cmath>

#include "gtest/gtest.h"
#include "overtone/core/simulation/random.h"

namespace overtone {
namespace {

Obstacle Crate() {
  Obstacle crate;
  crate.center = {5, 0};
  crate.half_size = {1, 2};
  crate.bottom = -1;
  crate.top = 1.5;
  return crate;
}

Obstacle Pillar() {
  Obstacle pillar = Crate();
  pillar.round = true;
  return pillar;
}

TEST(Obstacle, ARayHitsTheFaceItComesTo) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX(), z = Eigen::Vector3d::UnitZ();
  EXPECT_DOUBLE_EQ(CastRay(Crate(), {0, 1, 1}, x), 4);
  EXPECT_DOUBLE_EQ(CastRay(Crate(), {9, 1, 1}, -x), 3);
  EXPECT_DOUBLE_EQ(CastRay(Crate(), {5, 1, 4}, -z), 2.5);
  EXPECT_DOUBLE_EQ(CastRay(Pillar(), {0, 0, 1}, x), 4);
  EXPECT_DOUBLE_EQ(CastRay(Pillar(), {0, 0.6, 1}, x), 4.2);
  EXPECT_DOUBLE_EQ(CastRay(Pillar(), {5.5, 0, 4}, -z), 2.5);
}

TEST(Obstacle, ARayPastItOrAwayFromItOrFromInsideHitsNothing) {
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  for (const Obstacle& obstacle : {Crate(), Pillar()}) {
    EXPECT_TRUE(std::isinf(CastRay(obstacle, {0, 2.1, 1}, x)));
    EXPECT_TRUE(std::isinf(CastRay(obstacle, {0, 0, 1.6}, x)));
    EXPECT_TRUE(std::isinf(CastRay(obstacle, {0, 0, 1}, -x)));
    EXPECT_TRUE(std::isinf(CastRay(obstacle, {5, 0, 1}, x)));
  }
}

TEST(Obstacle, ATurnedBoxIsHitWhereItsTurnedFaceIs) {
  Obstacle crate = Crate();
  crate.axis = {0.6, 0.8};
  // Along its own long axis, towards the face two metres from the centre.
  const Eigen::Vector3d along(-0.8, 0.6, 0);
  const Eigen::Vector3d center(5, 0, 1);
  EXPECT_NEAR(CastRay(crate, center - 6 * along, along), 4, 1e-12);
}

TEST(Obstacle, DistancesAreThoseOfASolidAlsoFromInside) {
  EXPECT_DOUBLE_EQ(DistanceToSurface(Crate(), {7, 1, 0}), 1);
  EXPECT_DOUBLE_EQ(DistanceToSurface(Crate(), {9, 6, 0}), 5);        // 3, 4 off an edge
  EXPECT_DOUBLE_EQ(DistanceToSurface(Crate(), {5, 0, 1.25}), 0.25);  // below the lid
  EXPECT_DOUBLE_EQ(DistanceToSurface(Pillar(), {9, 3, 0}), 4);
  EXPECT_DOUBLE_EQ(DistanceToSurface(Pillar(), {5, 0, 1.75}), 0.25);
}

TEST(Obstacle, WhereARayHitsIsOnTheSurface) {
  Random random(3);
  int hits = 0;
  for (int i = 0; i < 2000; ++i) {
    Obstacle obstacle = i % 2 == 0 ? Crate() : Pillar();
    obstacle.axis = random.Normal3().head<2>().normalized();
    const Eigen::Vector3d origin = Eigen::Vector3d(5, 0, 0) + 4 * random.Normal3();
    const Eigen::Vector3d target = Eigen::Vector3d(5, 0, 0) + random.Normal3();
    const Eigen::Vector3d direction = (target - origin).normalized();
    const double range = CastRay(obstacle, origin, direction);
    if (std::isinf(range)) continue;
    ++hits;
    EXPECT_NEAR(DistanceToSurface(obstacle, origin + range * direction), 0, 1e-9);
  }
  EXPECT_GT(hits, 1000);
}

}  // namespace
}  // namespace overtone
