// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/bounded_voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <set>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using Eigen::Vector3d;
using Voxel = BoundedVoxelGrid::Voxel;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

std::vector<Vector3d> Means(const BoundedVoxelGrid& grid) {
  std::vector<Vector3d> means;
  for (const auto& [key, voxel] : grid.voxels()) {
    means.push_back(grid.origin() + voxel.mean.cast<double>());
  }
  std::sort(means.begin(), means.end(),
            [](const Vector3d& a, const Vector3d& b) { return a.x() < b.x(); });
  return means;
}

TEST(BoundedVoxelGrid, ACubeHoldsTheMeanOfItsPointsAndIntensities) {
  BoundedVoxelGrid grid(/*voxel_m=*/1, /*max_voxels=*/10);
  grid.Add({10, 20, 30}, 100);
  grid.Add({10.5, 20.25, 30}, 200);
  grid.Add({12.5, 20, 30}, 7);
  const std::vector<Vector3d> means = Means(grid);
  ASSERT_EQ(means.size(), 2u);
  EXPECT_TRUE(means[0].isApprox(Vector3d(10.25, 20.125, 30)));
  EXPECT_TRUE(means[1].isApprox(Vector3d(12.5, 20, 30)));
  std::multiset<float> intensities;
  for (const auto& [key, voxel] : grid.voxels()) intensities.insert(voxel.intensity);
  EXPECT_THAT(intensities, testing::ElementsAre(7, 150));
  EXPECT_EQ(grid.voxel_m(), 1);
}

// The mean of all points stays what it was, however often cubes were merged.
TEST(BoundedVoxelGrid, CubesGrowUntilThereAreFewEnoughAndNoPointIsLost) {
  BoundedVoxelGrid grid(/*voxel_m=*/0.1, /*max_voxels=*/100);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-20, 20);
  Vector3d sum = Vector3d::Zero();
  constexpr int kPoints = 20'000;
  for (int i = 0; i < kPoints; ++i) {
    const Vector3d point(uniform(random), uniform(random), 0);
    grid.Add(point, 0);
    sum += point;
    ASSERT_LE(grid.voxels().size(), 100u);
  }
  int64_t count = 0;
  Vector3d weighted = Vector3d::Zero();
  for (const auto& [key, voxel] : grid.voxels()) {
    count += voxel.num_points;
    weighted += voxel.num_points * (grid.origin() + voxel.mean.cast<double>());
  }
  EXPECT_EQ(count, kPoints);
  EXPECT_LT((weighted - sum).norm() / kPoints, 1e-3);
  // 40 m x 40 m in at most 100 cubes: 4 m each at least, and not much more.
  EXPECT_GE(grid.voxel_m(), 4);
  EXPECT_LE(grid.voxel_m(), 4 * 2.01);
  const double steps = 2 * std::log2(grid.voxel_m() / 0.1);
  EXPECT_NEAR(steps, std::round(steps), 1e-6);
}

TEST(BoundedVoxelGrid, FarFromTheMapsOriginPointsKeepTheirPlace) {
  BoundedVoxelGrid grid(/*voxel_m=*/0.01, /*max_voxels=*/10);
  const Vector3d utm(4'500'000.011, 5'800'000.022, 100.033);
  grid.Add(utm, 0);
  grid.Add(utm + Vector3d(0.5, 0, 0), 0);
  const std::vector<Vector3d> means = Means(grid);
  ASSERT_EQ(means.size(), 2u);
  EXPECT_LT((means[0] - utm).norm(), 1e-6);
  EXPECT_LT((means[1] - utm - Vector3d(0.5, 0, 0)).norm(), 1e-6);
}

TEST(BoundedVoxelGrid, WhatHasNoPlaceInTheGridIsCountedAndLeftOut) {
  BoundedVoxelGrid grid(/*voxel_m=*/1, /*max_voxels=*/10);
  grid.Add({kNan, 0, 0}, 0);
  grid.Add({1, 2, 3}, 0);
  grid.Add({1, 2, 3 + 2e6}, 0);
  grid.Add({1, std::numeric_limits<double>::infinity(), 3}, 0);
  EXPECT_EQ(grid.left_out(), 3);
  EXPECT_EQ(grid.voxels().size(), 1u);
}

}  // namespace
}  // namespace overtone
