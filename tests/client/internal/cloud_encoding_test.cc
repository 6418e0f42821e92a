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
  const auto blobs = EncodeClouds(submap, {}, message);
  ASSERT_TRUE(blobs.ok()) << blobs.status();
  ASSERT_EQ(blobs->size(), 2u);
  for (int i = 0; i < 2; ++i) {
    const WaitingBlob& blob = (*blobs)[i];
    EXPECT_EQ(blob.sequence, 3);
    EXPECT_EQ(blob.sha256, Sha256(*blob.bytes));
    EXPECT_EQ(message.clouds(i).sha256(), blob.sha256);
    EXPECT_EQ(message.clouds(i).encoded_bytes(), blob.bytes->size());
    EXPECT_EQ(DecodePointCloud(*blob.bytes)->size(), submap.clouds[i].cloud->size());
  }
  EXPECT_NE((*blobs)[0].sha256, (*blobs)[1].sha256);
  EXPECT_TRUE(FromProto(message, TestMission()).ok());
}

TEST(CloudEncoding, NamesWhatIsWrong) {
  const auto error = [](const Submap& submap) {
    v1::Submap message = ToProto(submap);
    const absl::Status status = EncodeClouds(submap, {}, message).status();
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument);
    return std::string(status.message());
  };
  Submap missing = WithClouds(StraightSubmap(0), 2);
  missing.clouds[1].cloud = nullptr;
  EXPECT_THAT(error(missing), StartsWith("clouds[1].cloud: null"));
  Submap not_finite = WithClouds(StraightSubmap(0), 1);
  PointCloud cloud = *not_finite.clouds[0].cloud;
  cloud.points[4].y() = NAN;
  not_finite.clouds[0].cloud = std::make_shared<const PointCloud>(cloud);
  EXPECT_THAT(error(not_finite), StartsWith("clouds[0].points[4]:"));
  Submap many = StraightSubmap(0);
  many.clouds.resize(2001);
  EXPECT_THAT(error(many), StartsWith("clouds: 2001"));
}

}  // namespace
}  // namespace overtone
