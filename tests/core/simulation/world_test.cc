// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/world.h"

#include <cmath>
#include <string>

#include "gtest/gtest.h"
#include "overtone/core/simulation/random.h"
#include "overtone/core/simulation/scene.h"

namespace overtone {
namespace {

// x from -6 to 10, y from -4 to 4, z from 0 to 3.
FloorPlan RoomPlan() {
  FloorPlan plan;
  Space room;
  room.center = {2, 0};
  room.half_size = {8, 4};
  plan.spaces = {room};
  return plan;
}

const Eigen::Vector3d kX = Eigen::Vector3d::UnitX();
const Eigen::Vector3d kY = Eigen::Vector3d::UnitY();
const Eigen::Vector3d kZ = Eigen::Vector3d::UnitZ();

TEST(World, RaysHitKnownWallsGroundAndCeilingAtTheKnownDistance) {
  const World world(RoomPlan());
  const Eigen::Vector3d origin(1.2, 0.7, 1.1);
  EXPECT_NEAR(world.CastRay(origin, kX, 50), 8.8, 1e-12);
  EXPECT_NEAR(world.CastRay(origin, -kX, 50), 7.2, 1e-12);
  EXPECT_NEAR(world.CastRay(origin, kY, 50), 3.3, 1e-12);
  EXPECT_NEAR(world.CastRay(origin, -kZ, 50), 1.1, 1e-12);
  EXPECT_NEAR(world.CastRay(origin, kZ, 50), 1.9, 1e-12);
  // 3, 4, 5: down onto the ground, and up to the ceiling.
  EXPECT_NEAR(world.CastRay({0, 0, 1.5}, {0.8, 0, -0.6}, 50), 2.5, 1e-12);
  EXPECT_NEAR(world.CastRay({0, 0, 1.5}, {0, 0.8, 0.6}, 50), 2.5, 1e-12);
}

TEST(World, ATurnedWallIsStraightToo) {
  FloorPlan plan = RoomPlan();
  plan.spaces[0].axis = Eigen::Vector2d(4, 1).normalized();
  const World world(plan);
  const Eigen::Vector2d across(-plan.spaces[0].axis.y(), plan.spaces[0].axis.x());
  for (double along = -6; along <= 6; along += 0.37) {
    const Eigen::Vector2d p = plan.spaces[0].center + along * plan.spaces[0].axis;
    EXPECT_NEAR(world.CastRay({p.x(), p.y(), 1}, {across.x(), across.y(), 0}, 50), 4, 1e-9);
  }
}

// Cells meet there: rounding must not let a ray slip through between them.
TEST(World, RaysAimedExactlyAtTheCornersOfCellsHitThem) {
  const World world(RoomPlan());
  Random random(6);
  for (int i = 0; i < 20000; ++i) {
    const Eigen::Vector3d origin = Eigen::Vector3d(2, 0, 1.5) + 0.3 * random.Normal3();
    Eigen::Vector3d target(-5 + 0.5 * random.Below(29), -3 + 0.5 * random.Below(13), 0);
    if (i % 3 == 1) target.z() = 3;   // ceiling
    if (i % 3 == 2) target.y() = -4;  // where wall and ground meet
    const double distance = (target - origin).norm();
    EXPECT_NEAR(world.CastRay(origin, (target - origin) / distance, 50), distance, 1e-9)
        << origin.transpose() << " to " << target.transpose();
  }
}

TEST(World, ObstaclesHideWhatIsBehindThemAndOnlyThat) {
  FloorPlan plan = RoomPlan();
  Obstacle crate;
  crate.center = {4, 0};
  crate.half_size = {0.5, 1};
  crate.top = 1;
  plan.obstacles = {crate};
  const World world(plan);
  EXPECT_NEAR(world.CastRay({0, 0.3, 0.9}, kX, 50), 3.5, 1e-12);
  EXPECT_NEAR(world.CastRay({0, 0.3, 1.1}, kX, 50), 10, 1e-12);
  EXPECT_NEAR(world.CastRay({0, 1.2, 0.9}, kX, 50), 10, 1e-12);
}

TEST(World, BeyondItsRangeAndInTheSkyARayHitsNothing) {
  FloorPlan plan = RoomPlan();
  const World room(plan);
  EXPECT_TRUE(std::isinf(room.CastRay({0, 0, 1}, kX, 9.9)));
  EXPECT_TRUE(std::isinf(room.CastRay({99, 0, 1}, kX, 50)));  // outside the world
  plan.spaces[0].height = kOpenSky;
  plan.sky = 5;
  const World yard(plan);
  EXPECT_TRUE(std::isinf(yard.CastRay({0, 0, 1}, kZ, 50)));
  EXPECT_TRUE(std::isinf(yard.CastRay({0, 0, 1}, {0.8, 0, 0.6}, 50)));          // over the wall
  EXPECT_NEAR(yard.CastRay({0, 0, 1}, {0.96, 0, 0.28}, 50), 10 / 0.96, 1e-12);  // onto it
}

TEST(World, DistancesAreToTheNearestOfAllSurfaces) {
  FloorPlan plan = RoomPlan();
  const World world(plan);
  EXPECT_NEAR(world.DistanceToSurface({0, 0, 1}, 9), 1, 1e-12);      // ground
  EXPECT_NEAR(world.DistanceToSurface({0, 0, 2.6}, 9), 0.4, 1e-12);  // ceiling
  EXPECT_NEAR(world.DistanceToSurface({9.3, 0, 1.5}, 9), 0.7, 1e-12);
  EXPECT_NEAR(world.DistanceToSurface({0, 0, 1.5}, 0.2), 0.2, 1e-12);  // the limit
  Obstacle pillar;
  pillar.round = true;
  pillar.center = {0, 0};
  pillar.half_size = {0.5, 0.5};
  pillar.top = 3;
  plan.obstacles = {pillar};
  EXPECT_NEAR(World(plan).DistanceToSurface({0.9, 0, 1.5}, 9), 0.4, 1e-12);
}

// In every scene, from its waypoints: what is hit is a surface, and up to there the way is open.
TEST(World, InEveryScenePointsLieOnSurfacesAndNoRayPassesThroughAWall) {
  for (const std::string& name : SceneNames()) {
    const auto scene = MakeScene(name, /*seed=*/1);
    ASSERT_TRUE(scene.ok()) << scene.status();
    const World world(scene->plan);
    Random random(4);
    int hits = 0;
    for (const Eigen::Vector2d& waypoint : scene->graph.positions()) {
      const Eigen::Vector3d origin(waypoint.x(), waypoint.y(), world.GroundHeight(waypoint) + 0.8);
      for (int i = 0; i < 100; ++i) {
        Eigen::Vector3d direction = random.Normal3();
        direction.z() *= 0.3;
        direction.normalize();
        const double range = world.CastRay(origin, direction, 50);
        if (std::isinf(range)) continue;
        ++hits;
        const Eigen::Vector3d hit = origin + range * direction;
        EXPECT_LT(world.DistanceToSurface(hit, 1), 1e-6) << name << ": " << hit.transpose();
        for (double t = 0; t < range - 0.01; t += 0.25) {
          const Eigen::Vector3d p = origin + t * direction;
          const FloorPlan::Column column = scene->plan.At(p.head<2>());
          EXPECT_LT(column.wall, 0.3) << name << ": " << p.transpose();  // a cell's roughness
          EXPECT_GT(p.z(), world.GroundHeight(p.head<2>()) - 1e-9) << name;
        }
      }
    }
    EXPECT_GT(hits, 1000) << name;
  }
}

}  // namespace
}  // namespace overtone
