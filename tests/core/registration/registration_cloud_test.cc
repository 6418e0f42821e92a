// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/registration_cloud.h"

#include <limits>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/support/simulated_scans.h"

namespace overtone {
namespace {

using testing::HasSubstr;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

std::vector<Eigen::Vector3f> RoomPoints(const Scanner& scanner) {
  Random random(1);
  return Scan(RoomWorld(), StandingAt(0, 0, 0), scanner, random).points;
}

TEST(RegistrationCloud, DefaultOptionsAreValid) {
  EXPECT_TRUE(RegistrationCloudOptions().Validate().ok());
}

TEST(RegistrationCloud, NamesTheOptionThatIsNotValid) {
  RegistrationCloudOptions options;
  options.voxel_size_m = kNan;
  EXPECT_THAT(options.Validate().message(), HasSubstr("voxel_size_m"));
  options = {};
  options.num_neighbors = 2;
  EXPECT_THAT(options.Validate().message(), HasSubstr("num_neighbors"));
  options = {};
  options.correlation_length_m = 0;
  EXPECT_THAT(options.Validate().message(), HasSubstr("correlation_length_m"));
  options = {};
  options.planar_thickness_m = -1;
  EXPECT_THAT(RegistrationCloud::Create(RoomPoints(Scanner()), options).status().message(),
              HasSubstr("planar_thickness_m"));
}

TEST(RegistrationCloud, IsMadeOfFinitePointsOnly) {
  auto points = RoomPoints(Scanner());
  const auto clean = RegistrationCloud::Create(points, {});
  points.insert(points.begin(), 100, Eigen::Vector3f(kNan, 0, 0));
  const auto cloud = RegistrationCloud::Create(points, {});
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  EXPECT_EQ((*cloud)->points(), (*clean)->points());
  EXPECT_EQ((*cloud)->normals().size(), (*cloud)->size());
  EXPECT_EQ((*cloud)->independence().size(), (*cloud)->size());
  EXPECT_FALSE((*cloud)->planar());
}

TEST(RegistrationCloud, RefusesTooFewPointsAndSaysHowManyAreLeft) {
  EXPECT_EQ(RegistrationCloud::Create({}, {}).status().code(), absl::StatusCode::kInvalidArgument);
  std::vector<Eigen::Vector3f> points(500, Eigen::Vector3f(1, 1, 1));
  points.resize(900, Eigen::Vector3f(kNan, kNan, kNan));
  const auto cloud = RegistrationCloud::Create(points, {});
  EXPECT_EQ(cloud.status().code(), absl::StatusCode::kInvalidArgument);
  EXPECT_THAT(cloud.status().message(), HasSubstr("of 900 points 1 are left"));
}

TEST(RegistrationCloud, OfAPlanarLaserIsLevelWhateverItsHeight) {
  auto points = RoomPoints(PlanarScanner());
  for (Eigen::Vector3f& point : points) point.z() += 0.3f;
  const auto cloud = RegistrationCloud::Create(points, {});
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  EXPECT_TRUE((*cloud)->planar());
  for (int i = 0; i < (*cloud)->size(); ++i) {
    EXPECT_EQ((*cloud)->points()[i].z(), 0);
    EXPECT_EQ((*cloud)->normals()[i].direction.z(), 0);
  }
}

}  // namespace
}  // namespace overtone
