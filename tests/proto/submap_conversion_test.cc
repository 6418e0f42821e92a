// SPDX-License-Identifier: Apache-2.0
// Round trips. What is refused, field by field, is in
// tests/services/mapping_server/upload_submaps_test.cc, where the answer of the server is tested
// with it.
#include "overtone/proto/conversion/submap_conversion.h"

#include <random>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/proto/conversion/geometry_conversion.h"
#include "overtone/tests/proto/conversion_fixture.h"

namespace overtone {
namespace {

using testing::AddOneOfEach;
using testing::FullCovariance;
using testing::MakeClosure;
using testing::MakeSubmap;
using testing::operator==;

constexpr int kSeed = 3;
const MissionId kMission = {"anna", "run1"};

TEST(GeometryConversion, APoseSurvivesBitByBit) {
  std::mt19937 random(kSeed);
  for (int i = 0; i < 1000; ++i) {
    const Rigid3d pose = testing::RandomPose(random, 1e6);
    const auto decoded = FromProto(ToProto(pose));
    ASSERT_TRUE(decoded.ok()) << decoded.status();
    EXPECT_TRUE(*decoded == pose);
  }
}

TEST(GeometryConversion, AQuaternionWithinAThousandthIsNormalised) {
  v1::Pose message = ToProto(Rigid3d());
  message.mutable_orientation()->set_w(1.0009);
  const auto decoded = FromProto(message);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_NEAR(decoded->rotation.norm(), 1.0, 1e-15);
  message.mutable_orientation()->set_w(1.0011);
  EXPECT_FALSE(FromProto(message).ok());
}

TEST(GeometryConversion, ACovarianceSurvivesBitByBit) {
  const auto decoded = FromProto(ToProto(FullCovariance()));
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  for (int i = 0; i < 36; ++i) {
    EXPECT_EQ(decoded->data()[i],
              Matrix6d(FullCovariance().selfadjointView<Eigen::Upper>()).data()[i]);
  }
}

TEST(GeometryConversion, ASemiDefiniteCovarianceIsRefusedAtAnyScale) {
  for (const double scale : {1e-12, 1.0, 1e9}) {
    Matrix6d covariance = scale * Matrix6d::Identity();
    EXPECT_TRUE(FromProto(ToProto(covariance)).ok()) << scale;
    covariance(0, 1) = covariance(1, 0) = scale;  // fully correlated
    EXPECT_FALSE(FromProto(ToProto(covariance)).ok()) << scale;
  }
}

// Its correlation is beyond a double, which makes NaNs of the pivots after it.
TEST(GeometryConversion, ACovarianceFarBeyondItsVariancesIsRefused) {
  Matrix6d covariance = 0.001 * Matrix6d::Identity();
  covariance(0, 1) = covariance(1, 0) = 0.0001;
  covariance(0, 4) = covariance(4, 0) = -4e306;
  EXPECT_FALSE(FromProto(ToProto(covariance)).ok());
}

TEST(SubmapConversion, ASubmapSurvivesTheRoundTrip) {
  Submap submap = MakeSubmap(2, 20, 7);
  submap.keyframes[4].degenerate = true;
  submap.loop_closures.push_back(MakeClosure({kMission, 21}, {{"bert", "x"}, 400}));
  const auto decoded = FromProto(ToProto(submap), kMission);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(decoded->sequence, 2);
  EXPECT_EQ(decoded->first_index, 20);
  ASSERT_EQ(decoded->keyframes.size(), 7u);
  for (int i = 0; i < 7; ++i) {
    EXPECT_EQ(decoded->keyframes[i].stamp, submap.keyframes[i].stamp);
    EXPECT_TRUE(decoded->keyframes[i].mission_from_body == submap.keyframes[i].mission_from_body);
    EXPECT_TRUE(
        decoded->keyframes[i].motion_covariance.isApprox(submap.keyframes[i].motion_covariance));
    EXPECT_EQ(decoded->keyframes[i].degenerate, i == 4);
  }
  ASSERT_EQ(decoded->loop_closures.size(), 1u);
  EXPECT_EQ(decoded->loop_closures[0].from, submap.loop_closures[0].from);
  EXPECT_EQ(decoded->loop_closures[0].to, submap.loop_closures[0].to);
  EXPECT_TRUE(decoded->loop_closures[0].from_tform_to == submap.loop_closures[0].from_tform_to);
}

TEST(SubmapConversion, WhatLiesBesideKeyframesSurvivesTheRoundTrip) {
  Submap submap = MakeSubmap(2, 20, 7);
  AddOneOfEach(kMission, submap);
  const auto decoded = FromProto(ToProto(submap), kMission);
  ASSERT_TRUE(decoded.ok()) << decoded.status();
  EXPECT_EQ(decoded->keyframes[3].degenerate_direction, submap.keyframes[3].degenerate_direction);
  EXPECT_TRUE(decoded->keyframes[2].degenerate_direction.isZero(0));
  ASSERT_EQ(decoded->candidates.size(), 1u);
  EXPECT_EQ(decoded->candidates[0].from, submap.candidates[0].from);
  EXPECT_EQ(decoded->candidates[0].to, submap.candidates[0].to);
  EXPECT_EQ(decoded->candidates[0].score, 0.75);
  ASSERT_EQ(decoded->clouds.size(), 1u);
  EXPECT_EQ(decoded->clouds[0].index, 22);
  EXPECT_EQ(decoded->clouds[0].sha256, std::string(32, 'c'));
  EXPECT_EQ(decoded->clouds[0].encoded_bytes, 1234);
  ASSERT_EQ(decoded->landmark_sightings.size(), 1u);
  EXPECT_EQ(decoded->landmark_sightings[0].index, 22);
  EXPECT_EQ(decoded->landmark_sightings[0].landmark, "tag_7");
  EXPECT_EQ(decoded->landmark_sightings[0].point_in_body, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(decoded->landmark_sightings[0].covariance, submap.landmark_sightings[0].covariance);
  ASSERT_EQ(decoded->robot_sightings.size(), 1u);
  EXPECT_EQ(decoded->robot_sightings[0].index, 22);
  EXPECT_EQ(decoded->robot_sightings[0].robot, "bert");
  EXPECT_EQ(decoded->robot_sightings[0].point_in_body, Eigen::Vector3d(4, 5, 6));
  EXPECT_EQ(decoded->robot_sightings[0].covariance, submap.robot_sightings[0].covariance);
  ASSERT_EQ(decoded->absolute_poses.size(), 1u);
  EXPECT_EQ(decoded->absolute_poses[0].index, 22);
  EXPECT_TRUE(decoded->absolute_poses[0].map_from_body == submap.absolute_poses[0].map_from_body);
  EXPECT_TRUE(decoded->absolute_poses[0].covariance.isApprox(submap.absolute_poses[0].covariance));
}

TEST(SubmapConversion, OnlyTheMissionsFirstKeyframeGoesWithoutCovariance) {
  EXPECT_FALSE(ToProto(MakeSubmap(0, 0, 2)).keyframes(0).has_motion_covariance());
  EXPECT_TRUE(ToProto(MakeSubmap(0, 0, 2)).keyframes(1).has_motion_covariance());
  EXPECT_TRUE(ToProto(MakeSubmap(1, 2, 2)).keyframes(0).has_motion_covariance());
}

TEST(SubmapConversion, DamagedBytesNeverCrashTheDecoder) {
  std::mt19937 random(kSeed);
  Submap submap = MakeSubmap(1, 5, 6);
  submap.loop_closures.push_back(MakeClosure({kMission, 6}, {kMission, 2}));
  AddOneOfEach(kMission, submap);
  const std::string good = ToProto(submap).SerializeAsString();
  int refused = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string bytes = good;
    if (i % 2 == 0) bytes.resize(random() % bytes.size());
    for (int flips = random() % 4; flips > 0 && !bytes.empty(); --flips) {
      bytes[random() % bytes.size()] ^= static_cast<char>(1 << random() % 8);
    }
    v1::Submap message;
    refused += !message.ParseFromString(bytes) || !FromProto(message, kMission).ok();
  }
  EXPECT_GT(refused, 2500);
}

}  // namespace
}  // namespace overtone
