// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/common/rate_limit.h"

#include <algorithm>

#include "gtest/gtest.h"

namespace overtone {
namespace {

const absl::Time kStart = absl::UnixEpoch();
absl::Time At(double seconds) { return kStart + absl::Seconds(seconds); }

TEST(RateLimit, TheBurstGoesAtOnceAndThenOnlyTheRate) {
  RateLimit limit(/*per_s=*/2, /*burst=*/5);
  for (int i = 0; i < 5; ++i) EXPECT_EQ(limit.TryTake(1, kStart), absl::ZeroDuration());
  int taken = 0;
  for (int ms = 0; ms <= 10'000; ++ms) {
    taken += limit.TryTake(1, At(ms / 1000.0)) == absl::ZeroDuration();
  }
  EXPECT_EQ(taken, 20);
}

TEST(RateLimit, ARefusalSaysExactlyWhenTheNextTrySucceeds) {
  RateLimit limit(4, 1);
  EXPECT_EQ(limit.TryTake(1, kStart), absl::ZeroDuration());
  const absl::Duration wait = limit.TryTake(1, At(0.05));
  EXPECT_EQ(wait, absl::Milliseconds(200));
  EXPECT_GT(limit.TryTake(1, At(0.05) + wait - absl::Milliseconds(1)), absl::ZeroDuration());
  EXPECT_EQ(limit.TryTake(1, At(0.05) + wait), absl::ZeroDuration());
}

// Rates whose tenths are no binary fractions: what rounding lacks must be neither given away nor
// waited for.
TEST(RateLimit, RoundingGivesNothingAway) {
  RateLimit limit(/*per_s=*/0.1, /*burst=*/1);
  int taken = 0;
  for (int s = 0; s < 100'000; ++s) taken += limit.TryTake(1, At(s)) == absl::ZeroDuration();
  EXPECT_NEAR(taken, 10'000, 1);
}

TEST(RateLimit, WhatIsLargerThanTheBurstPassesWithAFullOne) {
  RateLimit limit(1, 3);
  EXPECT_EQ(limit.TryTake(100, kStart), absl::ZeroDuration());
  EXPECT_EQ(limit.TryTake(100, kStart), absl::Seconds(3));
}

// Whatever the sizes, reading pauses so long that the long-term rate is the limit.
TEST(RateLimit, ADebtIsPaidInFull) {
  RateLimit limit(100, 50);
  absl::Time now = kStart;
  double charged = 0;
  for (int i = 0; i < 200; ++i) {
    const double size = 1 + i % 37 * 10;
    now += limit.Charge(size, now);
    charged += size;
  }
  EXPECT_NEAR(absl::ToDoubleSeconds(now - kStart), (charged - 50) / 100, 1e-6);
}

// One message at a time: pauses of a second or of a full burst, and still the rate.
TEST(RateLimit, AShortestPauseMakesPausesFewerAndNotTheRateLower) {
  for (const double burst : {50.0, 1000.0}) {
    RateLimit limit(100, burst);
    absl::Time now = kStart;
    int pauses = 0;
    for (int i = 0; i < 5000; ++i) {
      const absl::Duration pause = limit.Charge(1, now, absl::Seconds(1));
      now += pause;
      pauses += pause > absl::ZeroDuration();
    }
    EXPECT_NEAR(absl::ToDoubleSeconds(now - kStart), (5000 - burst) / 100, 1) << burst;
    EXPECT_NEAR(pauses, (5000 - burst) / std::min(burst, 100.0), 2) << burst;
  }
}

TEST(RateLimit, TimeThatStepsBackNeitherGivesNorTakes) {
  RateLimit limit(1, 1);
  EXPECT_EQ(limit.TryTake(1, At(100)), absl::ZeroDuration());
  EXPECT_EQ(limit.TryTake(1, At(0)), absl::Seconds(1));
  EXPECT_EQ(limit.TryTake(1, At(101)), absl::ZeroDuration());
}

TEST(RateLimit, ZeroIsNoLimit) {
  RateLimit limit(0, 1);
  for (int i = 0; i < 1000; ++i) EXPECT_EQ(limit.TryTake(1e9, kStart), absl::ZeroDuration());
  EXPECT_EQ(limit.Charge(1e9, kStart), absl::ZeroDuration());
  EXPECT_TRUE(limit.IsFull(kStart));
}

}  // namespace
}  // namespace overtone
