// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/lidar.h"

#include <cmath>
#include <limits>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

// 24 m x 16 m x 3 m around the origin.
World Room() {
  FloorPlan plan;
  Space room;
  room.half_size = {12, 8};
  plan.spaces = {room};
  return World(plan);
}

PointCloud Scan(const LidarOptions& options, const Rigid3d& world_from_body, uint64_t seed = 1) {
  const auto lidar = Lidar::Create(options);
  EXPECT_TRUE(lidar.ok()) << lidar.status();
  Random random(seed);
  return lidar->Scan(Room(), world_from_body, random);
}

TEST(Lidar, WithoutNoiseEveryPointLiesOnASurfaceAtItsBeamsElevation) {
  LidarOptions options;
  options.range_sigma_m = 0;
  const Rigid3d world_from_body(ExpSO3({0.05, -0.1, 2}), {3, -2, 0.6});
  const PointCloud cloud = Scan(options, world_from_body);
  ASSERT_EQ(cloud.size(), 16u * 900);
  const World room = Room();
  for (size_t i = 0; i < cloud.size(); ++i) {
    const Eigen::Vector3d point = cloud.points[i].cast<double>();
    EXPECT_LT(room.DistanceToSurface(world_from_body * point, 1), 1e-5);
    const double elevation = std::atan2(point.z() - 0.3, point.head<2>().norm()) * 180 / M_PI;
    EXPECT_NEAR(elevation, -15 + 2 * static_cast<double>(i % 16), 1e-3);
  }
}

TEST(Lidar, ALimitedFieldOfViewLooksStraightAhead) {
  LidarOptions options;
  options.rings = 2;
  options.columns = 720;
  options.horizontal_fov_deg = 90;
  const PointCloud cloud = Scan(options, Rigid3d(Eigen::Quaterniond::Identity(), {0, 0, 0.6}));
  ASSERT_EQ(cloud.size(), 2u * 180);
  double left = 0, right = 0;
  for (const Eigen::Vector3f& point : cloud.points) {
    const double azimuth = std::atan2(point.y(), point.x()) * 180 / M_PI;
    left = std::max(left, azimuth);
    right = std::min(right, azimuth);
  }
  EXPECT_NEAR(left, 44.75, 1e-3);
  EXPECT_NEAR(right, -44.75, 1e-3);
}

TEST(Lidar, RangeNoiseHasTheStatedSigma) {
  LidarOptions quiet;
  quiet.range_sigma_m = 0;
  LidarOptions noisy;
  noisy.range_sigma_m = 0.05;
  const Rigid3d world_from_body(Eigen::Quaterniond::Identity(), {1, 2, 0.6});
  const PointCloud truth = Scan(quiet, world_from_body), cloud = Scan(noisy, world_from_body);
  ASSERT_EQ(cloud.size(), truth.size());
  const Eigen::Vector3f sensor(0, 0, 0.3f);
  double sum_of_squares = 0;
  for (size_t i = 0; i < cloud.size(); ++i) {
    const double error = (cloud.points[i] - sensor).norm() - (truth.points[i] - sensor).norm();
    sum_of_squares += error * error;
  }
  // Five standard errors: sigma / sqrt(2 n).
  EXPECT_NEAR(std::sqrt(sum_of_squares / static_cast<double>(cloud.size())), 0.05,
              5 * 0.05 / std::sqrt(2.0 * static_cast<double>(cloud.size())));
}

TEST(Lidar, WhatIsTooNearOrTooFarLeavesNoPoint) {
  LidarOptions options;
  options.max_range_m = 8;
  options.min_range_m = 5;
  const PointCloud cloud = Scan(options, Rigid3d(Eigen::Quaterniond::Identity(), {0, 0, 0.6}));
  EXPECT_GT(cloud.size(), 1000u);
  EXPECT_LT(cloud.size(), 14400u);
  for (const Eigen::Vector3f& point : cloud.points) {
    const double range = (point - Eigen::Vector3f(0, 0, 0.3f)).norm();
    EXPECT_GE(range, 5 - 1e-5);
    EXPECT_LE(range, 8 + 0.12);  // six sigma
  }
}

TEST(Lidar, ThePlanarLaserSeesOneLevelLine) {
  const LidarOptions options = LidarOptions::Planar();
  const PointCloud cloud = Scan(options, Rigid3d(Eigen::Quaterniond::Identity(), {0, 0, 0.6}));
  EXPECT_EQ(cloud.size(), 1080u);
  for (const Eigen::Vector3f& point : cloud.points) EXPECT_EQ(point.z(), 0.3f);
}

TEST(Lidar, OneSeedGivesOneScan) {
  const Rigid3d pose(Eigen::Quaterniond::Identity(), {0, 0, 0.6});
  EXPECT_EQ(Scan({}, pose, 7).points, Scan({}, pose, 7).points);
  EXPECT_NE(Scan({}, pose, 7).points, Scan({}, pose, 8).points);
}

TEST(Lidar, DefaultsAreValidAndBadMembersAreNamed) {
  EXPECT_TRUE(LidarOptions().Validate().ok());
  EXPECT_TRUE(LidarOptions::Planar().Validate().ok());
  const auto message = [](auto set) {
    LidarOptions options;
    set(options);
    return std::string(Lidar::Create(options).status().message());
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(message([](auto& o) { o.rings = 0; }),
            "LidarOptions.rings: must be from 1 to 256, is 0");
  EXPECT_THAT(message([](auto& o) { o.vertical_fov_deg = 180; }), HasSubstr(".vertical_fov_deg"));
  EXPECT_THAT(message([](auto& o) { o.columns = 3; }), HasSubstr(".columns"));
  EXPECT_THAT(message([](auto& o) { o.horizontal_fov_deg = 361; }),
              HasSubstr(".horizontal_fov_deg"));
  EXPECT_THAT(message([](auto& o) { o.min_range_m = -1; }), HasSubstr(".min_range_m"));
  EXPECT_THAT(message([](auto& o) { o.max_range_m = 0.1; }), HasSubstr(".max_range_m"));
  EXPECT_THAT(message([&](auto& o) { o.range_sigma_m = nan; }), HasSubstr(".range_sigma_m"));
  EXPECT_THAT(message([](auto& o) { o.mounting_height_m = 11; }), HasSubstr(".mounting_height_m"));
}

}  // namespace
}  // namespace overtone
