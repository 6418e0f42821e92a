// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/voxel_grid.h"

#include <limits>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using Eigen::Vector3f;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(VoxelGrid, KeepsTheMeanOfEachCubeInTheOrderOfFirstSight) {
  const auto centroids = VoxelCentroids({{1.25f, 0, 0}, {0.5f, 0, 0}, {1.75f, 0.5f, 0}}, 1);
  EXPECT_THAT(centroids, testing::ElementsAre(Vector3f(1.5f, 0.25f, 0), Vector3f(0.5f, 0, 0)));
}

TEST(VoxelGrid, CubesMeetAtZeroWithoutOverlapping) {
  EXPECT_EQ(VoxelCentroids({{-0.1f, -0.1f, -0.1f}, {0.1f, 0.1f, 0.1f}}, 1).size(), 2);
}

TEST(VoxelGrid, LeavesOutPointsThatAreNotFiniteOrTooFar) {
  const auto centroids = VoxelCentroids(
      {{kNan, 0, 0}, {0, kInfinity, 0}, {0, 0, -3e38f}, {0, 0, 1048576}, {1, 2, 3}}, 1);
  EXPECT_THAT(centroids, testing::ElementsAre(Vector3f(1, 2, 3)));
}

TEST(VoxelGrid, FarCubesHaveKeysOfTheirOwn) {
  const auto far = VoxelKey({1048575, -1048575, 1048575}, 1);
  ASSERT_TRUE(far.has_value());
  EXPECT_NE(far, VoxelKey({1048574, -1048575, 1048575}, 1));
  EXPECT_NE(far, VoxelKey({1048575, -1048574, 1048575}, 1));
  EXPECT_NE(far, VoxelKey({-1048575, 1048575, 1048575}, 1));
}

TEST(VoxelGrid, MeansFarFromTheOriginStayInTheirCube) {
  std::vector<Vector3f> points(1000, Vector3f(100000.25f, 0, 0));
  const auto centroids = VoxelCentroids(points, 0.25f);
  ASSERT_EQ(centroids.size(), 1);
  EXPECT_EQ(centroids[0], points[0]);
}

TEST(VoxelGrid, SharesOfACubeAddUpToOneUnlessItHoldsFewerThanTheLeast) {
  const std::vector<Vector3f> points = {
      {0, 0, 0}, {0, 0, 0.5f}, {0, 0, 0.6f}, {5, 0, 0}, {kNan, 0, 0}};
  const float third = 1.0f / 3;
  EXPECT_THAT(VoxelShares(points, 1, /*least=*/2),
              testing::ElementsAre(third, third, third, 0.5f, 0));
}

}  // namespace
}  // namespace overtone
