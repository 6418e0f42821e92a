// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/comparison_pace.h"

#include "gtest/gtest.h"

namespace overtone {
namespace {

TEST(ComparisonPace, QuickComparisonsComeAsOftenAsTheyMay) {
  EXPECT_EQ(PauseAfterComparison(absl::Milliseconds(5), absl::Seconds(1)), absl::Seconds(1));
}

TEST(ComparisonPace, SlowOnesTakeATenthOfACore) {
  for (const auto took : {absl::Milliseconds(200), absl::Seconds(3)}) {
    const absl::Duration pause = PauseAfterComparison(took, absl::Seconds(1));
    EXPECT_EQ(absl::FDivDuration(took, took + pause), 0.1);
  }
}

TEST(ComparisonPace, NeverStaysNever) {
  EXPECT_EQ(PauseAfterComparison(absl::Seconds(1), absl::InfiniteDuration()),
            absl::InfiniteDuration());
}

}  // namespace
}  // namespace overtone
