// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/value_noise.h"

#include <cmath>

#include "gtest/gtest.h"

namespace overtone {
namespace {

// Worlds are made of these numbers: they must never change.
TEST(ValueNoise, GivesTheSameNumbersOnEveryPlatform) {
  EXPECT_DOUBLE_EQ(ValueNoise(1, {0, 0}), -0.11099964925957839);
  EXPECT_DOUBLE_EQ(ValueNoise(1, {-2.25, 7.5}), 0.3875464655956534);
}

TEST(ValueNoise, StaysWithinOneAndReachesTowardsItOnBothSides) {
  double low = 0, high = 0, sum = 0;
  for (int i = 0; i < 100; ++i) {
    for (int j = 0; j < 100; ++j) {
      const double value = ValueNoise(5, {i, j});
      low = std::min(low, value);
      high = std::max(high, value);
      sum += value;
    }
  }
  EXPECT_GE(low, -1);
  EXPECT_LE(high, 1);
  EXPECT_LT(low, -0.99);
  EXPECT_GT(high, 0.99);
  EXPECT_NEAR(sum / 1e4, 0, 5 * std::sqrt(1.0 / 3) / 100);  // five standard errors
}

TEST(ValueNoise, IsContinuousAndFlatWhereCoordinatesAreIntegers) {
  const double h = 1e-7;
  for (const double y : {-3.0, 0.0, 0.3, 11.9}) {
    for (const double x : {-5.0, 0.0, 4.0}) {
      EXPECT_NEAR(ValueNoise(2, {x - h, y}), ValueNoise(2, {x + h, y}), 1e-12);
      EXPECT_NEAR(ValueNoise(2, {y, x - h}), ValueNoise(2, {y, x + h}), 1e-12);
    }
  }
}

TEST(ValueNoise, SeedsAndAxesDiffer) {
  EXPECT_NE(ValueNoise(1, {3, 4}), ValueNoise(2, {3, 4}));
  EXPECT_NE(ValueNoise(1, {3, 4}), ValueNoise(1, {4, 3}));
}

}  // namespace
}  // namespace overtone
