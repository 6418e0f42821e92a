// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/cloud_encoding.h"

#include <cmath>
#include <memory>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/tests/support/straight_mission.h"

namespace overtone {
namespace {

using testing::StartsWith;

TEST(CloudEncoding, NamesEachBlobInItsReference) {
  const Submap submap = WithClouds(StraightSubmap(3), 2);
  v1::Submap message = ToProto(submap);
  ASSERT_TRUE(AnnounceClouds(submap, message).ok());
  const EncodedClouds encoded = EncodeClouds(submap.clouds, {}, message);
  EXPECT_TRUE(encoded.failures.empty());
  ASSERT_EQ(encoded.blobs.size(), 2u);
  for (int i = 0; i < 2; ++i) {
    const WaitingBlob& blob = encoded.blobs[i];
    EXPECT_EQ(blob.sequence, 3);
    EXPECT_EQ(blob.sha256, Sha256(*blob.bytes));
    EXPECT_EQ(message.clouds(i).sha256(), blob.sha256);
    EXPECT_EQ(message.clouds(i).encoded_bytes(), blob.bytes->size());
    EXPECT_EQ(DecodePointCloud(*blob.bytes)->size(), submap.clouds[i].cloud->size());
  }
  EXPECT_NE(encoded.blobs[0].sha256, encoded.blobs[1].sha256);
  EXPECT_TRUE(FromProto(message, TestMission()).ok());
}

// What is checked before is what is sent afterwards, and no longer.
TEST(CloudEncoding, AnAnnouncedSubmapIsCheckedAsTheEncodedOne) {
  const Submap submap = WithClouds(StraightSubmap(3), 2);
  v1::Submap message = ToProto(submap);
  ASSERT_TRUE(AnnounceClouds(submap, message).ok());
  EXPECT_TRUE(FromProto(message, TestMission()).ok());
  const size_t announced = message.ByteSizeLong();
  EncodeClouds(submap.clouds, {}, message);
  EXPECT_LE(message.ByteSizeLong(), announced);
  Submap twice = submap;
  twice.clouds[1].index = twice.clouds[0].index;
  message = ToProto(twice);
  ASSERT_TRUE(AnnounceClouds(twice, message).ok());
  EXPECT_THAT(std::string(FromProto(message, TestMission()).status().message()),
              StartsWith("clouds[1].index"));
}

TEST(CloudEncoding, NamesWhatIsMissing) {
  const auto error = [](const Submap& submap) {
    v1::Submap message = ToProto(submap);
    const absl::Status status = AnnounceClouds(submap, message);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    return std::string(status.message());
  };
  Submap missing = WithClouds(StraightSubmap(0), 2);
  missing.clouds[1].cloud = nullptr;
  EXPECT_THAT(error(missing), StartsWith("clouds[1].cloud: null"));
  Submap many = StraightSubmap(0);
  many.clouds.resize(2001);
  EXPECT_THAT(error(many), StartsWith("clouds: 2001"));
}

TEST(CloudEncoding, ACloudThatCannotBeEncodedCostsNothingElse) {
  Submap submap = WithClouds(StraightSubmap(0), 3);
  PointCloud cloud = *submap.clouds[1].cloud;
  cloud.points[4].y() = NAN;
  submap.clouds[1].cloud = std::make_shared<const PointCloud>(cloud);
  v1::Submap message = ToProto(submap);
  ASSERT_TRUE(AnnounceClouds(submap, message).ok());
  const EncodedClouds encoded = EncodeClouds(submap.clouds, {}, message);
  ASSERT_EQ(encoded.failures.size(), 1u);
  EXPECT_THAT(std::string(encoded.failures[0].message()), StartsWith("clouds[1].points[4]:"));
  ASSERT_EQ(encoded.blobs.size(), 2u);
  ASSERT_EQ(message.clouds_size(), 2);
  EXPECT_EQ(message.clouds(1).index(), 2);
  EXPECT_EQ(message.clouds(1).sha256(), encoded.blobs[1].sha256);
  EXPECT_EQ(message.keyframes_size(), 10);
  EXPECT_TRUE(FromProto(message, TestMission()).ok());
}

}  // namespace
}  // namespace overtone
