// SPDX-License-Identifier: Apache-2.0
// What real clouds take on the wire. The data is read from beside the project and never part of it.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include "gtest/gtest.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/core/graph/point_cloud_io.h"

namespace overtone {
namespace {

constexpr char kData[] = OVERTONE_SOURCE_DIR "/../shared/data/";

// Sorted along each axis alone, both must agree within the bound.
void ExpectSameWithin(const PointCloud& a, const PointCloud& b, double bound_m) {
  ASSERT_EQ(a.size(), b.size());
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<float> x, y;
    for (const auto& point : a.points) x.push_back(point[axis]);
    for (const auto& point : b.points) y.push_back(point[axis]);
    std::sort(x.begin(), x.end());
    std::sort(y.begin(), y.end());
    for (size_t i = 0; i < x.size(); ++i) ASSERT_NEAR(x[i], y[i], bound_m);
  }
}

struct Size {
  double points = 0;
  double bytes = 0;
};

Size SizeOf(PointCloud cloud) {
  cloud.intensities.clear();
  const auto bytes = EncodePointCloud(cloud, {});
  EXPECT_TRUE(bytes.ok()) << bytes.status();
  const auto decoded = DecodePointCloud(*bytes);
  EXPECT_TRUE(decoded.ok()) << decoded.status();
  ExpectSameWithin(cloud, *decoded, 0.00501);
  return {static_cast<double>(cloud.size()), static_cast<double>(bytes->size())};
}

TEST(PublicCloudBytes, LivoxScansTakeAboutTwoBytesAPoint) {
  const std::string folder = std::string(kData) + "hku_livox/Scans";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  Size sum;
  int clouds = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto cloud = ReadPointCloud(entry.path());
    ASSERT_TRUE(cloud.ok()) << cloud.status();
    const Size size = SizeOf(*cloud);
    sum.points += size.points;
    sum.bytes += size.bytes;
    ++clouds;
  }
  std::printf("%.2f bytes a point, %.0f a keyframe\n", sum.bytes / sum.points, sum.bytes / clouds);
  EXPECT_LT(sum.bytes / sum.points, 2.15);
}

TEST(PublicCloudBytes, ADenseScanTakesAboutOneByteAPoint) {
  const std::string path = std::string(kData) + "registration/source.ply";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const auto cloud = ReadPointCloud(path);
  ASSERT_TRUE(cloud.ok()) << cloud.status();
  const Size size = SizeOf(*cloud);
  std::printf("%.2f bytes a point\n", size.bytes / size.points);
  EXPECT_LT(size.bytes / size.points, 1.15);
}

}  // namespace
}  // namespace overtone
