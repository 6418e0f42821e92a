// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/random.h"

#include <set>

#include "gtest/gtest.h"

namespace overtone {
namespace {

// The standard states the 10000th number of the engine with its default seed, 5489 (rand.predef).
TEST(Random, IsTheEngineOfTheStandard) {
  Random random(5489);
  for (int i = 1; i < 10000; ++i) random.Fork();
  EXPECT_EQ(random.Fork(), 9981545732273789042u);
}

// These numbers must never change: the example team and tests are made of them.
TEST(Random, GivesTheSameNumbersOnEveryPlatform) {
  Random random(42);
  EXPECT_DOUBLE_EQ(random.Uniform(), 0.75515553295453897);
  EXPECT_EQ(random.Below(1000), 824);
  EXPECT_NEAR(random.Normal(), 0.49458385623521306, 1e-12);
}

TEST(Random, NormalHasMeanZeroVarianceOneAndNormalTails) {
  Random random(7);
  const int n = 200'000;
  double sum = 0, sum_of_squares = 0, sum_of_fourth_powers = 0;
  for (int i = 0; i < n; ++i) {
    const double x = random.Normal();
    sum += x;
    sum_of_squares += x * x;
    sum_of_fourth_powers += x * x * x * x;
  }
  // Five standard errors each: 1 / sqrt(n), sqrt(2 / n), sqrt(96 / n).
  EXPECT_NEAR(sum / n, 0, 0.011);
  EXPECT_NEAR(sum_of_squares / n, 1, 0.016);
  EXPECT_NEAR(sum_of_fourth_powers / n, 3, 0.11);
}

TEST(Random, SuccessiveNormalsAreUncorrelated) {
  Random random(8);
  const int n = 100'000;
  double sum = 0, previous = random.Normal();
  for (int i = 0; i < n; ++i) {
    const double x = random.Normal();
    sum += x * previous;
    previous = x;
  }
  EXPECT_NEAR(sum / n, 0, 0.016);  // five standard errors
}

TEST(Random, BelowReachesEveryValueAndNoOther) {
  Random random(9);
  std::set<int> seen;
  for (int i = 0; i < 200; ++i) seen.insert(random.Below(5));
  EXPECT_EQ(seen, (std::set<int>{0, 1, 2, 3, 4}));
}

TEST(Random, ForksDiffer) {
  Random random(10);
  Random a(random.Fork()), b(random.Fork());
  EXPECT_NE(a.Uniform(), b.Uniform());
}

}  // namespace
}  // namespace overtone
