// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/token_bucket.h"

#include <random>

#include "gtest/gtest.h"

namespace overtone {
namespace {

using Clock = TokenBucket::Clock;
using std::chrono::milliseconds;
using std::chrono::seconds;

const Clock::time_point kStart = Clock::time_point() + seconds(1000);

TEST(TokenBucket, WithoutABoundEverythingMayGoAtOnce) {
  TokenBucket bucket(0);
  bucket.Take(int64_t{1} << 40, kStart);
  EXPECT_EQ(bucket.ReadyAt(kStart), kStart);
}

TEST(TokenBucket, ADebtIsPaidOffBeforeTheNextMessage) {
  TokenBucket bucket(1000);
  EXPECT_EQ(bucket.ReadyAt(kStart), kStart);
  bucket.Take(1000, kStart);  // all that was in it
  EXPECT_EQ(bucket.ReadyAt(kStart), kStart);
  bucket.Take(2500, kStart);
  EXPECT_EQ(bucket.ReadyAt(kStart), kStart + milliseconds(2500));
  EXPECT_EQ(bucket.ReadyAt(kStart + seconds(1)), kStart + milliseconds(2500));
  EXPECT_EQ(bucket.ReadyAt(kStart + seconds(3)), kStart + seconds(3));
}

TEST(TokenBucket, SavesUpNoMoreThanASecond) {
  TokenBucket bucket(1000);
  const Clock::time_point later = kStart + std::chrono::hours(1);
  bucket.Take(3000, later);
  EXPECT_EQ(bucket.ReadyAt(later), later + seconds(2));
}

// The law it is for, over any stretch of time that begins with the bucket.
TEST(TokenBucket, NoMoreGoesThanTheRateASecondMoreAndOneMessage) {
  constexpr int64_t kRate = 8000, kLargest = 20'000;
  std::mt19937 random(7);
  std::uniform_int_distribution<int64_t> size(1, kLargest);
  std::uniform_int_distribution<int> pause_ms(0, 300);
  TokenBucket bucket(kRate);
  Clock::time_point now = kStart;
  int64_t sent = 0;
  for (int i = 0; i < 2000; ++i) {
    now = std::max(now, bucket.ReadyAt(now)) + milliseconds(i % 5 == 0 ? pause_ms(random) : 0);
    const int64_t bytes = size(random);
    bucket.Take(bytes, now);
    sent += bytes;
    const double elapsed_s = std::chrono::duration<double>(now - kStart).count();
    ASSERT_LE(static_cast<double>(sent), kRate * (elapsed_s + 1) + kLargest + 1);
  }
  // And no less either, when there is always something to send.
  const double elapsed_s = std::chrono::duration<double>(now - kStart).count();
  EXPECT_GT(static_cast<double>(sent), 0.9 * kRate * elapsed_s);
}

}  // namespace
}  // namespace overtone
