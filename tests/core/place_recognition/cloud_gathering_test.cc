// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/place_recognition/cloud_gathering.h"

#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;

CloudAtPose Keyframe(const Rigid3d& mission_from_body, const Eigen::Vector3f& point,
                     const std::vector<uint8_t>& intensities = {}) {
  auto cloud = std::make_shared<PointCloud>();
  cloud->points = {point};
  cloud->intensities = intensities;
  return {mission_from_body, cloud};
}

CloudAtPose At(double x) {
  return Keyframe({Eigen::Quaterniond::Identity(), {x, 0, 0}}, {0, 0, 0});
}

TEST(GatheringStart, CountsTheWayNotTheDistance) {
  const std::vector<CloudAtPose> there_and_back = {At(0), At(3), At(0), At(2)};
  EXPECT_EQ(GatheringStart(there_and_back, 0), 3u);
  EXPECT_EQ(GatheringStart(there_and_back, 2), 2u);
  EXPECT_EQ(GatheringStart(there_and_back, 4.9), 2u);
  EXPECT_EQ(GatheringStart(there_and_back, 5), 1u);
  EXPECT_EQ(GatheringStart(there_and_back, 100), 0u);
}

// A wall point at (4, 0, 0) of the mission, seen 1 m ahead; the newest body looks left from
// (4, 2, 0), so the point is 2 m behind it.
TEST(GatherClouds, BringsPointsIntoTheNewestBody) {
  const Eigen::Quaterniond left(Eigen::AngleAxisd(M_PI / 2, Eigen::Vector3d::UnitZ()));
  const std::vector<CloudAtPose> keyframes = {
      Keyframe({Eigen::Quaterniond::Identity(), {3, 0, 0}}, {1, 0, 0}),
      Keyframe({left, {4, 2, 0}}, {5, 6, 7})};
  const PointCloud cloud = GatherClouds(keyframes, 10);
  ASSERT_EQ(cloud.size(), 2u);
  EXPECT_TRUE(cloud.points[0].isApprox(Eigen::Vector3f(-2, 0, 0), 1e-5)) << cloud.points[0];
  EXPECT_TRUE(cloud.points[1].isApprox(Eigen::Vector3f(5, 6, 7), 1e-6));
}

TEST(GatherClouds, KeepsIntensitiesOnlyWhenAllHaveThem) {
  const Rigid3d origin;
  const CloudAtPose with = Keyframe(origin, {1, 0, 0}, {9});
  const CloudAtPose without = Keyframe(origin, {1, 0, 0});
  EXPECT_THAT(GatherClouds({with, CloudAtPose{origin, nullptr}, with}, 1).intensities,
              ElementsAre(9, 9));
  EXPECT_TRUE(GatherClouds({with, without}, 1).intensities.empty());
  EXPECT_EQ(GatherClouds({with, without}, 1).size(), 2u);
}

}  // namespace
}  // namespace overtone
