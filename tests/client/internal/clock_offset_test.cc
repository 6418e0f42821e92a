// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/clock_offset.h"

#include <random>

#include "gtest/gtest.h"

namespace overtone {
namespace {

const absl::Time kNow = absl::FromUnixSeconds(1'700'000'000);

// The robot asks at steady time `at`; its clock is `offset` ahead of the server's.
void Ask(ClockOffset& clock, absl::Duration at, absl::Duration offset, absl::Duration there,
         absl::Duration back) {
  const absl::Time sent = kNow + at;
  clock.Add(sent, there + back, sent - offset + there, at + there + back);
}

TEST(ClockOffset, KnowsNothingBeforeTheFirstAnswer) {
  EXPECT_FALSE(ClockOffset().Get(absl::Seconds(5)).has_value());
}

TEST(ClockOffset, HalfTheRoundTripBoundsTheOffsetHoweverUnequalTheWays) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> delay_s(0.001, 0.4);
  for (int run = 0; run < 200; ++run) {
    ClockOffset clock;
    const absl::Duration offset = absl::Seconds(delay_s(random) * 10 - 2);
    for (int i = 0; i < 12; ++i) {
      Ask(clock, absl::Seconds(30 * i), offset, absl::Seconds(delay_s(random)),
          absl::Seconds(delay_s(random)));
    }
    const auto estimate = clock.Get(absl::Seconds(360));
    ASSERT_TRUE(estimate.has_value());
    EXPECT_LE(absl::AbsDuration(estimate->offset - offset), estimate->uncertainty);
  }
}

TEST(ClockOffset, TheFastestAnswerCounts) {
  ClockOffset clock;
  Ask(clock, absl::Seconds(0), absl::Seconds(2), absl::Milliseconds(400), absl::Milliseconds(0));
  Ask(clock, absl::Seconds(1), absl::Seconds(2), absl::Milliseconds(2), absl::Milliseconds(2));
  Ask(clock, absl::Seconds(2), absl::Seconds(2), absl::Milliseconds(0), absl::Milliseconds(300));
  const auto estimate = clock.Get(absl::Seconds(3));
  EXPECT_EQ(estimate->offset, absl::Seconds(2));
  EXPECT_GE(estimate->uncertainty, absl::Milliseconds(2));
  EXPECT_LT(estimate->uncertainty, absl::Milliseconds(3));
}

TEST(ClockOffset, BecomesLessCertainWithAge) {
  ClockOffset clock;
  Ask(clock, absl::Seconds(0), absl::Seconds(1), absl::Milliseconds(1), absl::Milliseconds(1));
  EXPECT_GT(clock.Get(absl::Hours(1))->uncertainty, absl::Milliseconds(300));
}

TEST(ClockOffset, AClockThatWasSetIsBelievedAtOnce) {
  ClockOffset clock;
  for (int i = 0; i < 8; ++i) {
    Ask(clock, absl::Seconds(i), absl::Seconds(100), absl::Milliseconds(1), absl::Milliseconds(1));
  }
  Ask(clock, absl::Seconds(9), absl::Seconds(1), absl::Milliseconds(200), absl::Milliseconds(200));
  EXPECT_EQ(clock.Get(absl::Seconds(9))->offset, absl::Seconds(1));
}

TEST(ClockWarning, IsGivenOnceForEachChangeAndOnlyOfWhatIsCertain) {
  using Word = ClockWarning::Word;
  ClockWarning warning(absl::Milliseconds(500));
  const auto judge = [&](double offset_s, double uncertainty_s) {
    return warning.Judge({absl::Seconds(offset_s), absl::Seconds(uncertainty_s)});
  };
  EXPECT_EQ(judge(0.1, 0.01), Word::kNone);
  EXPECT_EQ(judge(0.6, 0.2), Word::kNone);  // may be 0.4
  EXPECT_EQ(judge(-0.6, 0.01), Word::kWarn);
  EXPECT_EQ(judge(-0.6, 0.01), Word::kNone);
  EXPECT_EQ(judge(-0.9, 0.01), Word::kNone);
  EXPECT_EQ(judge(-5, 0.01), Word::kWarn);
  EXPECT_EQ(judge(0.1, 0.9), Word::kNone);  // may be anything
  EXPECT_EQ(judge(0.1, 0.01), Word::kBackToNormal);
  EXPECT_EQ(judge(0.1, 0.01), Word::kNone);
}

}  // namespace
}  // namespace overtone
