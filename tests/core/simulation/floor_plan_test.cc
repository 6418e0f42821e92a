// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/floor_plan.h"

#include <algorithm>
#include <cmath>

#include "gtest/gtest.h"

namespace overtone {
namespace {

TEST(FloorPlan, OneShapeIsRoomHallAndTunnel) {
  Space room;
  room.center = {1, 2};
  room.half_size = {4, 3};
  EXPECT_DOUBLE_EQ(room.Distance({1, 2}), -3);
  EXPECT_DOUBLE_EQ(room.Distance({7, 2}), 2);
  EXPECT_DOUBLE_EQ(room.Distance({8, 9}), 5);  // 3, 4 off a corner

  Space hall;
  hall.radius = 5;
  EXPECT_DOUBLE_EQ(hall.Distance({3, 4}), 0);

  Space tunnel;
  tunnel.axis = {0.6, 0.8};
  tunnel.half_size = {10, 0};
  tunnel.radius = 2;
  EXPECT_NEAR(tunnel.Distance(6 * tunnel.axis), -2, 1e-12);
  EXPECT_NEAR(tunnel.Distance(13 * tunnel.axis), 1, 1e-12);
  EXPECT_NEAR(tunnel.Distance(3 * tunnel.axis + 2.5 * Eigen::Vector2d(-0.8, 0.6)), 0.5, 1e-12);
}

TEST(FloorPlan, SpacesUniteAndTheDeeperOneHasItsCeiling) {
  FloorPlan plan;
  Space low, high;
  low.half_size = {5, 5};
  high.center = {8, 0};
  high.half_size = {5, 5};
  high.height = 7;
  plan.spaces = {low, high};
  EXPECT_DOUBLE_EQ(plan.At({0, 0}).wall, -5);
  EXPECT_DOUBLE_EQ(plan.At({0, 0}).ceiling, 3);
  EXPECT_DOUBLE_EQ(plan.At({8, 0}).ceiling, 7);
  EXPECT_LT(plan.At({4, 0}).wall, 0);
  EXPECT_GT(plan.At({14, 0}).wall, 0);
}

TEST(FloorPlan, RoughnessAndReliefStayWithinTheirBoundsAndUseThem) {
  FloorPlan plan;
  Space cave;
  cave.half_size = {60, 60};
  cave.roughness = 0.8;
  cave.relief = 0.5;
  plan.spaces = {cave};
  double most_wall = 0, most_ground = 0;
  for (int i = -50; i <= 50; ++i) {
    const Eigen::Vector2d p(i, 59);
    const FloorPlan::Column column = plan.At(p);
    most_wall = std::max(most_wall, std::abs(column.wall - cave.Distance(p)));
    most_ground = std::max(most_ground, std::abs(column.ground));
    EXPECT_NEAR(column.ceiling - column.ground, 3, 0.8);
  }
  EXPECT_LE(most_wall, 0.8);
  EXPECT_GT(most_wall, 0.4);
  EXPECT_LE(most_ground, 0.5);
  EXPECT_GT(most_ground, 0.2);
}

// A level floor and a rough one meet in a slope, not in a step.
TEST(FloorPlan, GroundHasNoStepsBetweenSpaces) {
  FloorPlan plan;
  Space level, rough;
  level.half_size = {10, 4};
  rough.center = {20, 0};
  rough.half_size = {10, 4};
  rough.relief = 1;
  plan.spaces = {level, rough};
  for (plan.seed = 0; plan.seed < 20; ++plan.seed) {
    for (double x = 5; x < 15; x += 0.1) {
      EXPECT_LT(std::abs(plan.At({x + 0.1, 0}).ground - plan.At({x, 0}).ground), 0.1 * 0.4);
    }
  }
}

}  // namespace
}  // namespace overtone
