// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/backoff.h"

#include <algorithm>

#include "gtest/gtest.h"

namespace overtone {
namespace {

TEST(Backoff, DelaysLieInTheUpperHalfOfACeilingThatDoublesUpToTheMaximum) {
  Backoff backoff(absl::Milliseconds(100), absl::Seconds(1), /*seed=*/1);
  for (const int ceiling_ms : {100, 200, 400, 800, 1000, 1000, 1000}) {
    const absl::Duration delay = backoff.Next();
    EXPECT_GE(delay, absl::Milliseconds(ceiling_ms) / 2);
    EXPECT_LE(delay, absl::Milliseconds(ceiling_ms));
  }
}

TEST(Backoff, StartsOverAfterSuccess) {
  Backoff backoff(absl::Milliseconds(100), absl::Seconds(10), /*seed=*/2);
  for (int i = 0; i < 6; ++i) backoff.Next();
  backoff.Reset();
  EXPECT_LE(backoff.Next(), absl::Milliseconds(100));
}

TEST(Backoff, WaitsAsLongAsTheServerAskedWithinReason) {
  Backoff backoff(absl::Milliseconds(100), absl::Seconds(1), /*seed=*/3);
  EXPECT_EQ(backoff.Next(absl::Seconds(7)), absl::Seconds(7));
  EXPECT_LE(backoff.Next(absl::Milliseconds(1)), absl::Milliseconds(200));
  EXPECT_EQ(backoff.Next(absl::Hours(24)), absl::Minutes(10));
}

// A team that lost its server together must not come back in one instant: the earliest half of 100
// robots is spread over a good part of the window.
TEST(Backoff, ATeamSpreadsOut) {
  std::vector<double> delays_ms;
  for (uint64_t seed = 0; seed < 100; ++seed) {
    Backoff backoff(absl::Milliseconds(100), absl::Seconds(1), seed);
    delays_ms.push_back(absl::ToDoubleMilliseconds(backoff.Next()));
  }
  std::sort(delays_ms.begin(), delays_ms.end());
  EXPECT_GT(delays_ms[50] - delays_ms[0], 15);
  EXPECT_GT(delays_ms[99] - delays_ms[50], 15);
}

TEST(IsRetryable, HoldsForTheFourCodesOfTheSchemaOnly) {
  for (int code = 0; code <= 16; ++code) {
    const auto status_code = static_cast<absl::StatusCode>(code);
    const bool expected = status_code == absl::StatusCode::kUnavailable ||
                          status_code == absl::StatusCode::kDeadlineExceeded ||
                          status_code == absl::StatusCode::kResourceExhausted ||
                          status_code == absl::StatusCode::kAborted;
    EXPECT_EQ(IsRetryable(status_code), expected) << status_code;
  }
}

}  // namespace
}  // namespace overtone
