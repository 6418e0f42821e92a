// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/scene.h"

#include <algorithm>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/simulation/lidar.h"

namespace overtone {
namespace {

Scene Make(const std::string& name, uint64_t seed = 1) {
  auto scene = MakeScene(name, seed);
  EXPECT_TRUE(scene.ok()) << scene.status();
  return *std::move(scene);
}

TEST(Scene, EveryGraphIsDrivableAndEveryRouteDrivesAlongIt) {
  for (const std::string& name : SceneNames()) {
    const Scene scene = Make(name);
    EXPECT_TRUE(scene.graph.IsDrivable()) << name;
    EXPECT_GE(scene.routes.size(), 2u) << name;
    for (const std::vector<int>& route : scene.routes) {
      EXPECT_GT(scene.graph.Length(route), 150) << name;
      for (size_t i = 1; i < route.size(); ++i) {
        const int before = i > 1 ? route[i - 2] : -1;
        EXPECT_THAT(scene.graph.Onward(before, route[i - 1]), testing::Contains(route[i])) << name;
      }
    }
  }
}

TEST(Scene, TheFourRobotsUndergroundDriveTwoKilometres) {
  const Scene scene = Make("subterranean");
  double length_m = 0;
  for (const std::vector<int>& route : scene.routes) length_m += scene.graph.Length(route);
  EXPECT_EQ(scene.routes.size(), 4u);
  EXPECT_NEAR(length_m, 2000, 100);
}

TEST(Scene, ASeedMovesTheSurfacesButNotTheWays) {
  for (const std::string& name : SceneNames()) {
    const Scene a = Make(name, 1), same = Make(name, 1), b = Make(name, 2);
    EXPECT_EQ(a.graph.positions(), b.graph.positions());
    EXPECT_EQ(a.routes, b.routes);
    ASSERT_EQ(a.plan.obstacles.size(), same.plan.obstacles.size());
    for (size_t i = 0; i < a.plan.obstacles.size(); ++i) {
      EXPECT_EQ(a.plan.obstacles[i].center, same.plan.obstacles[i].center);
    }
    EXPECT_NE(a.plan.seed, b.plan.seed);
    EXPECT_NE(a.plan.obstacles.back().center, b.plan.obstacles.back().center);
  }
}

// Noise-free, at standing height, on the ground or off it.
PointCloud ScanAt(const World& world, double x, double y) {
  LidarOptions options;
  options.range_sigma_m = 0;
  Random random(1);
  return Lidar::Create(options)->Scan(
      world, Rigid3d(Eigen::Quaterniond::Identity(), {x, y, world.GroundHeight({x, y}) + 0.5}),
      random);
}

TEST(Scene, FarOutOnTheTerraceThereIsNothingButGround) {
  const Scene scene = Make("terrace");
  const World world(scene.plan);
  int far_out = 0;
  for (const Eigen::Vector2d& waypoint : scene.graph.positions()) {
    if (!scene.terrace->contains(waypoint) || waypoint.x() < 60) continue;
    ++far_out;
    const PointCloud cloud = ScanAt(world, waypoint.x(), waypoint.y());
    EXPECT_GT(cloud.size(), 1000u);
    for (const Eigen::Vector3f& point : cloud.points) EXPECT_NEAR(point.z(), -0.5, 1e-5);
  }
  EXPECT_EQ(far_out, 5);
}

TEST(Scene, IndoorsAndAtItsDoorTheTerraceIsNotEmpty) {
  const Scene scene = Make("terrace");
  const World world(scene.plan);
  for (const double x : {-15.5, 8.0}) {
    const PointCloud cloud = ScanAt(world, x, 0);
    const auto high = std::count_if(cloud.points.begin(), cloud.points.end(),
                                    [](const Eigen::Vector3f& point) { return point.z() > 0; });
    EXPECT_GT(high, 1000) << x;
  }
}

// The point of a degenerate corridor: no scan tells where along it one stands.
TEST(Scene, AllAlongTheFlaggedCorridorTheScansAreTheSame) {
  const Scene scene = Make("corridor");
  const World world(scene.plan);
  const double begin = scene.corridor->min().x(), end = scene.corridor->max().x();
  const PointCloud first = ScanAt(world, begin, 0.2);
  for (const double x : {begin + 7.3, (begin + end) / 2, end}) {
    const PointCloud here = ScanAt(world, x, 0.2);
    ASSERT_EQ(here.size(), first.size());
    for (size_t i = 0; i < here.size(); ++i) {
      EXPECT_LT((here.points[i] - first.points[i]).norm(), 1e-4);
    }
  }
  const PointCloud outside = ScanAt(world, 3, 0.2);
  double difference = 0;
  for (size_t i = 0; i < std::min(outside.size(), first.size()); ++i) {
    difference += (outside.points[i] - first.points[i]).norm();
  }
  EXPECT_GT(difference, 1000);
}

TEST(Scene, AnUnknownNameIsAnsweredWithTheKnownOnes) {
  const auto scene = MakeScene("moon", 1);
  EXPECT_EQ(scene.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_EQ(scene.status().message(),
            "no scene \"moon\", there are tunnel, terrace, corridor, subterranean");
}

}  // namespace
}  // namespace overtone
