// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/common/timestamp.h"

#include "gtest/gtest.h"

namespace overtone {
namespace {

// Today's epoch in a double has steps of 256 ns.
constexpr int64_t kToday = 1763776251123456789;

TEST(Timestamp, TellsNeighbouringNanosecondsApart) {
  const Timestamp now{kToday}, later{kToday + 1};
  EXPECT_LT(now, later);
  EXPECT_GT(later, now);
  EXPECT_LE(now, now);
  EXPECT_GE(now, now);
  EXPECT_NE(now, later);
  EXPECT_EQ(now, Timestamp{kToday});
}

TEST(SecondsBetween, KeepsTheNanosecondAtTodaysEpoch) {
  EXPECT_DOUBLE_EQ(SecondsBetween({kToday}, {kToday + 1}), 1e-9);
  EXPECT_DOUBLE_EQ(SecondsBetween({kToday + 1500000000}, {kToday}), -1.5);
}

}  // namespace
}  // namespace overtone
