// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/place_recognition/field_of_view.h"

#include "gtest/gtest.h"
#include "overtone/tests/core/place_recognition/synthetic_place.h"

namespace overtone {
namespace {

constexpr double kSector = 2 * M_PI / 60;

// One point in the middle of each of `sectors` sectors from `first` on.
PointCloud Arc(int first, int sectors) {
  PointCloud cloud;
  for (int k = first; k < first + sectors; ++k) {
    const double heading = -M_PI + (k + 0.5) * kSector;
    cloud.points.emplace_back(5 * std::cos(heading), 5 * std::sin(heading), 0);
  }
  return cloud;
}

TEST(SeesAllAround, FourInFiveSectorsAreEnoughAndOneLessIsNot) {
  for (const int first : {0, 17, 59}) {
    EXPECT_TRUE(SeesAllAround(Arc(first, 48))) << first;
    EXPECT_FALSE(SeesAllAround(Arc(first, 47))) << first;
  }
}

TEST(SeesAllAround, ManyPointsInFewSectorsAreNotAllAround) {
  EXPECT_FALSE(SeesAllAround(SyntheticPlace(1, -1.6, 1.6, 10'000)));
  EXPECT_TRUE(SeesAllAround(SyntheticPlace(1)));
}

TEST(SeesAllAround, SectorsMayBeScattered) {
  PointCloud cloud = Arc(0, 60);
  for (int k = 55; k > 0; k -= 5) cloud.points.erase(cloud.points.begin() + k);  // 49 are left
  EXPECT_TRUE(SeesAllAround(cloud));
}

// Straight back is +pi or -pi, of which one is the last sector's end.
TEST(SeesAllAround, StraightBackCountsAsASector) {
  PointCloud cloud = Arc(1, 47);
  EXPECT_FALSE(SeesAllAround(cloud));
  cloud.points.emplace_back(-5, 0, 0);
  EXPECT_TRUE(SeesAllAround(cloud));
}

TEST(SeesAllAround, NothingSeesNothing) { EXPECT_FALSE(SeesAllAround(PointCloud())); }

}  // namespace
}  // namespace overtone
