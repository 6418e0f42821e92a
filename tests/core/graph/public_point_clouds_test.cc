// SPDX-License-Identifier: Apache-2.0
// Real clouds, read whole. The data is read from beside the project and never part of it.
#include <algorithm>
#include <filesystem>
#include <string>

#include "gtest/gtest.h"
#include "overtone/core/graph/point_cloud_io.h"

namespace overtone {
namespace {

constexpr char kData[] = OVERTONE_SOURCE_DIR "/../shared/data/";

TEST(PublicPointClouds, LivoxScansAreReadWhole) {
  const std::string folder = std::string(kData) + "hku_livox/Scans";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  size_t clouds = 0;
  size_t points = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const auto cloud = ReadPointCloud(entry.path());
    ASSERT_TRUE(cloud.ok()) << cloud.status();
    EXPECT_EQ(cloud->intensities.size(), cloud->size());
    for (const auto& point : cloud->points) EXPECT_LT(point.norm(), 300) << entry.path();
    EXPECT_GT(*std::max_element(cloud->intensities.begin(), cloud->intensities.end()), 100);
    ++clouds;
    points += cloud->size();
  }
  EXPECT_EQ(clouds, 314u);
  std::printf("%zu clouds, %zu points a cloud\n", clouds, points / std::max<size_t>(clouds, 1));
}

TEST(PublicPointClouds, TheRegistrationPairIsReadWhole) {
  const std::string folder = std::string(kData) + "registration/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
  const auto source = ReadPointCloud(folder + "source.ply");
  const auto target = ReadPointCloud(folder + "target.ply");
  ASSERT_TRUE(source.ok()) << source.status();
  ASSERT_TRUE(target.ok()) << target.status();
  EXPECT_EQ(source->size(), 69792u);
  EXPECT_EQ(target->size(), 69088u);
  EXPECT_EQ(source->intensities.size(), source->size());
}

}  // namespace
}  // namespace overtone
