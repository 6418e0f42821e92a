// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/graph/point_cloud_codec.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using testing::HasSubstr;

constexpr int kSeed = 11;
constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

// Two walls and a floor, as a sensor would see them; planar: a single wall in a plane.
PointCloud Room(int num_points, bool planar, bool with_intensities) {
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> uniform(-20, 20);
  PointCloud cloud;
  for (int i = 0; i < num_points; ++i) {
    Eigen::Vector3f point(uniform(random), uniform(random), planar ? 0 : uniform(random) / 8);
    if (!planar) point[i % 3] = static_cast<float>(i % 3);
    cloud.points.push_back(point);
    // Tells the points apart when their order is gone.
    if (with_intensities) cloud.intensities.push_back(static_cast<uint8_t>(i));
  }
  return cloud;
}

std::string Encoded(const PointCloud& cloud, double resolution_m = 0.01) {
  const auto bytes = EncodePointCloud(cloud, {resolution_m});
  EXPECT_TRUE(bytes.ok()) << bytes.status();
  return bytes.ok() ? *bytes : "";
}

PointCloud Decoded(const std::string& bytes) {
  const auto cloud = DecodePointCloud(bytes);
  EXPECT_TRUE(cloud.ok()) << cloud.status();
  return cloud.ok() ? *cloud : PointCloud();
}

// The grid index of every coordinate, and the intensity: what decoding must give back.
using Row = std::vector<int64_t>;
std::vector<Row> SortedRows(const PointCloud& cloud, double resolution_m) {
  std::vector<Row> rows;
  for (size_t i = 0; i < cloud.size(); ++i) {
    Row row;
    for (int axis = 0; axis < 3; ++axis) {
      row.push_back(std::llrint(cloud.points[i][axis] / resolution_m));
    }
    row.push_back(cloud.intensities.empty() ? 0 : cloud.intensities[i]);
    rows.push_back(row);
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

TEST(CloudCodecOptions, TheDefaultIsValidAndNonsenseIsNot) {
  EXPECT_TRUE(CloudCodecOptions().Validate().ok());
  for (const double bad : {0.0, -0.01, 11.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ(CloudCodecOptions{bad}.Validate().code(), kInvalid) << bad;
  }
}

TEST(PointCloudCodec, EveryPointComesBackInItsCellWithItsIntensity) {
  for (const bool planar : {false, true}) {
    for (const double resolution_m : {0.001, 0.01, 0.2}) {
      const PointCloud cloud = Room(3000, planar, /*with_intensities=*/true);
      const PointCloud decoded = Decoded(Encoded(cloud, resolution_m));
      EXPECT_EQ(SortedRows(decoded, resolution_m), SortedRows(cloud, resolution_m));
    }
  }
}

// One point at a time, so that input and output belong together; the far ones where floats are
// coarsest.
TEST(PointCloudCodec, EachCoordinateIsWithinHalfTheResolutionAndAFloatsRounding) {
  std::mt19937 random(kSeed);
  for (const double resolution_m : {0.001, 0.01, 0.5}) {
    std::uniform_real_distribution<float> far(-4.19e6f * resolution_m, 4.19e6f * resolution_m);
    std::uniform_real_distribution<float> near(-30, 30);
    for (int i = 0; i < 2000; ++i) {
      auto& uniform = i % 2 == 0 ? far : near;
      PointCloud cloud;
      cloud.points.emplace_back(uniform(random), uniform(random), uniform(random));
      const PointCloud decoded = Decoded(Encoded(cloud, resolution_m));
      ASSERT_EQ(decoded.size(), 1u);
      for (int axis = 0; axis < 3; ++axis) {
        const double original = cloud.points[0][axis];
        const double rounding = std::abs(original) * std::numeric_limits<float>::epsilon();
        EXPECT_LE(std::abs(decoded.points[0][axis] - original),
                  0.5 * resolution_m * (1 + 1e-9) + rounding);
      }
    }
  }
}

TEST(PointCloudCodec, TheOrderOfThePointsDoesNotMatterAndADecodedCloudEncodesToTheSameBytes) {
  PointCloud cloud = Room(2000, /*planar=*/false, /*with_intensities=*/false);
  const std::string bytes = Encoded(cloud);
  std::shuffle(cloud.points.begin(), cloud.points.end(), std::mt19937(kSeed));
  EXPECT_EQ(Encoded(cloud), bytes);
  EXPECT_EQ(Encoded(Decoded(bytes)), bytes);
}

TEST(PointCloudCodec, PointsThatShareACellStayAsManyAsTheyAre) {
  PointCloud cloud;
  cloud.points.assign(1000, Eigen::Vector3f(1, 2, 3));
  cloud.intensities.assign(1000, 7);
  cloud.intensities[500] = 9;
  const PointCloud decoded = Decoded(Encoded(cloud));
  ASSERT_EQ(decoded.size(), 1000u);
  EXPECT_EQ(decoded.intensities.back(), 9);
  EXPECT_NEAR(decoded.points[999].z(), 3, 1e-6);
}

TEST(PointCloudCodec, AnEmptyCloudStaysEmpty) {
  EXPECT_TRUE(Decoded(Encoded(PointCloud())).empty());
}

// An axis that needs no bits must not cost any.
TEST(PointCloudCodec, APlanarCloudTakesTheBytesOfAPlane) {
  const PointCloud planar = Room(5000, /*planar=*/true, /*with_intensities=*/false);
  PointCloud lifted = planar;
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<float> uniform(-20, 20);
  for (Eigen::Vector3f& point : lifted.points) point.z() = uniform(random);
  // 4000 x 4000 cells and 5000 points: log2(16e6 / 5000) + log2(e) = 13.1 bits at best.
  EXPECT_LT(Encoded(planar).size(), 5000 * 1.75);
  EXPECT_GT(Encoded(lifted).size(), 5000 * 2.9);
}

TEST(PointCloudCodec, NamesWhatItCannotEncode) {
  const float inf = std::numeric_limits<float>::infinity();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const struct {
    PointCloud cloud;
    std::string message;
  } cases[] = {
      {{{{0, 0, 0}, {0, nan, 0}}, {}}, "points[1]"},
      {{{{inf, 0, 0}}, {}}, "points[0]"},
      {{{{0, 0, -5e4f}}, {}}, "points[0]"},
      {{{{-2e4f, 0, 0}, {2e4f, 0, 0}}, {}}, "extend over 40000 m"},
      {{{{0, 0, 0}}, {1, 2}}, "intensities: 2"},
      {{std::vector<Eigen::Vector3f>(kMaxCloudPoints + 1, Eigen::Vector3f::Zero()), {}},
       "points: 2097153"},
  };
  for (const auto& bad : cases) {
    const auto bytes = EncodePointCloud(bad.cloud, {});
    EXPECT_EQ(bytes.status().code(), kInvalid) << bad.message;
    EXPECT_THAT(std::string(bytes.status().message()), HasSubstr(bad.message));
  }
  EXPECT_EQ(EncodePointCloud({}, {0}).status().code(), kInvalid);
}

TEST(PointCloudCodec, MorePointsThanAllowedAreRefused) {
  const std::string bytes = Encoded(Room(100, false, false));
  EXPECT_TRUE(DecodePointCloud(bytes, {100}).ok());
  EXPECT_EQ(DecodePointCloud(bytes, {99}).status().code(), kInvalid);
}

// The number of points stands in bytes 5 to 8.
TEST(PointCloudCodec, ABombIsRefusedByWhatItsHeaderClaims) {
  PointCloud cloud;
  cloud.points.assign(kMaxCloudPoints, Eigen::Vector3f::Zero());
  const std::string dense = Encoded(cloud);
  EXPECT_LT(dense.size(), 1000u);  // as good a bomb as the format gives
  EXPECT_TRUE(DecodePointCloud(dense).ok());
  const auto with_claim = [&](uint32_t num_points) {
    std::string bytes = dense;
    std::memcpy(&bytes[5], &num_points, sizeof(num_points));
    return DecodePointCloud(bytes).status();
  };
  EXPECT_THAT(std::string(with_claim(4'000'000'000u).message()), HasSubstr("at most"));
  EXPECT_THAT(std::string(with_claim(kMaxCloudPoints - 1).message()), HasSubstr("not as long"));
  EXPECT_THAT(std::string(with_claim(0).message()), HasSubstr("not as long"));
}

TEST(PointCloudCodec, WhateverIsCutOffOrAddedIsNoticed) {
  const std::string good = Encoded(Room(300, false, true));
  for (size_t size = 0; size < good.size(); ++size) {
    EXPECT_EQ(DecodePointCloud(good.substr(0, size)).status().code(), kInvalid) << size;
  }
  EXPECT_EQ(DecodePointCloud(good + '\0').status().code(), kInvalid);
}

TEST(PointCloudCodec, NoBytesCrashTheDecoderAndWhatItTakesIsFinite) {
  std::mt19937 random(kSeed);
  const std::string goods[] = {Encoded(Room(60, false, true)), Encoded(Room(200, true, false)),
                               Encoded(Room(1, false, true))};
  int taken = 0;
  for (int i = 0; i < 40'000; ++i) {
    std::string bytes = goods[i % 3];
    if (i % 5 == 0) bytes.resize(random() % bytes.size());
    for (int flips = 1 + static_cast<int>(random() % 4); flips > 0 && !bytes.empty(); --flips) {
      // Half of them in the header, where they do most.
      const size_t range = random() % 2 == 0 ? std::min<size_t>(bytes.size(), 33) : bytes.size();
      bytes[random() % range] ^= static_cast<char>(1 << random() % 8);
    }
    const auto cloud = DecodePointCloud(bytes, {/*max_points=*/1000});
    if (!cloud.ok()) {
      ASSERT_EQ(cloud.status().code(), kInvalid) << cloud.status();
      continue;
    }
    ++taken;
    for (const Eigen::Vector3f& point : cloud->points) ASSERT_TRUE(point.allFinite());
  }
  std::printf("%d of 40000 mutations are clouds too\n", taken);
  EXPECT_GT(taken, 1000);
  EXPECT_LT(taken, 39'000);
}

}  // namespace
}  // namespace overtone
