// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/common/format_number.h"

#include <limits>

#include "gtest/gtest.h"
#include "overtone/core/common/parse_number.h"

namespace overtone {
namespace {

TEST(FormatDouble, IsShortAndReadsBackAsTheSameNumber) {
  EXPECT_EQ(FormatDouble(0.1), "0.1");
  EXPECT_EQ(FormatDouble(-2), "-2");
  for (const double value : {1.0 / 3, -2.2250738585072014e-308, 1.7976931348623157e308, 1e-17}) {
    EXPECT_EQ(*ParseFiniteDouble(FormatDouble(value)), value);
  }
}

TEST(FormatSeconds, WritesAllNineDecimals) {
  EXPECT_EQ(FormatSeconds({1403636580838555648}), "1403636580.838555648");
  EXPECT_EQ(FormatSeconds({1}), "0.000000001");
  EXPECT_EQ(FormatSeconds({-1500000000}), "-1.500000000");
  EXPECT_EQ(FormatSeconds({std::numeric_limits<int64_t>::min()}), "-9223372036.854775808");
}

TEST(FormatSeconds, ReadsBackExactly) {
  for (const int64_t ns : {0L, -7L, 1763776251123456789L, 1763776251123456790L}) {
    EXPECT_EQ(ParseSeconds(FormatSeconds({ns}))->ns, ns);
  }
}

}  // namespace
}  // namespace overtone
