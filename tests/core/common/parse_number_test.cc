// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/common/parse_number.h"

#include <limits>
#include <string>
#include <vector>

#include "gtest/gtest.h"

namespace overtone {
namespace {

TEST(ParseSeconds, IsExactToTheNanosecond) {
  const std::vector<std::pair<std::string, int64_t>> cases = {
      {"1403636580.83856", 1403636580838560000},
      {"1403636580.863555431", 1403636580863555431},
      {"1.403636579763555527e+09", 1403636579763555527},
      {"1.403636579763555527E9", 1403636579763555527},
      {"1403636579763555527e-9", 1403636579763555527},
      {"+0.000000001", 1},
      {"-12.5", -12500000000},
      {"7.", 7000000000},
      {".25", 250000000},
      {" 3 ", 3000000000},
      {"0", 0},
      {"0e10000", 0},
      {"-0.0", 0},
      {"1e-10000", 0},
      {"0.0000000014", 1},  // below the nanosecond: to the nearest
      {"0.0000000015", 2},
      {"0.0000000005", 1},
      {"0.00000000049999", 0},
      {"9223372036.854775806", 9223372036854775806},
      {"00000000000000000000000000000001.5", 1500000000},
  };
  for (const auto& [text, ns] : cases) {
    const auto stamp = ParseSeconds(text);
    ASSERT_TRUE(stamp.ok()) << text << ": " << stamp.status();
    EXPECT_EQ(stamp->ns, ns) << text;
  }
}

TEST(ParseSeconds, RefusesWhatIsNoTimeOrDoesNotFit) {
  for (const std::string& text : {std::string(),
                                  std::string("."),
                                  std::string("-"),
                                  std::string("e5"),
                                  std::string("1e"),
                                  std::string("1e+"),
                                  std::string("1.2.3"),
                                  std::string("1 2"),
                                  std::string("12s"),
                                  std::string("nan"),
                                  std::string("inf"),
                                  std::string("0x10"),
                                  std::string("--1"),
                                  std::string("9223372036.854775807"),
                                  std::string("9223372036.9"),
                                  std::string("1e10"),
                                  std::string("1e10000"),
                                  std::string("1e99999999999"),
                                  std::string("1e-99999999999"),
                                  std::string("1403636580863555431"),
                                  std::string(4000, '9')}) {
    EXPECT_EQ(ParseSeconds(text).status().code(), absl::StatusCode::kInvalidArgument) << text;
  }
}

TEST(ParseFiniteDouble, ReadsDecimalAndScientific) {
  EXPECT_EQ(*ParseFiniteDouble("-1.6456920911512e-37"), -1.6456920911512e-37);
  EXPECT_EQ(*ParseFiniteDouble("0.1"), 0.1);
  EXPECT_EQ(*ParseFiniteDouble("1e-400"), 0) << "too small to represent is zero, not an error";
}

TEST(ParseFiniteDouble, RefusesWordsNanAndInfinities) {
  for (const std::string text : {"", "x", "1.0x", "nan", "-nan", "NaN", "inf", "-inf", "1e400",
                                 "-1e400", "1,5", "--1", "1 2"}) {
    const auto value = ParseFiniteDouble(text);
    ASSERT_EQ(value.status().code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_EQ(value.status().message().find("'" + text + "'"), 0u) << value.status();
  }
}

TEST(ParseFiniteDoubles, RefusesTooFewAndTooMany) {
  const std::vector<absl::string_view> fields = {"1", "2"};
  std::vector<double> values(3);
  EXPECT_FALSE(ParseFiniteDoubles(fields, absl::MakeSpan(values)).ok());
  EXPECT_FALSE(ParseFiniteDoubles(fields, absl::MakeSpan(values).first(1)).ok());
  EXPECT_TRUE(ParseFiniteDoubles(fields, absl::MakeSpan(values).first(2)).ok());
  EXPECT_EQ(values[1], 2);
}

TEST(ParseNonNegativeInteger, CoversTheRangeAndNothingBeyond) {
  EXPECT_EQ(*ParseNonNegativeInteger("0"), 0);
  EXPECT_EQ(*ParseNonNegativeInteger("9223372036854775807"), std::numeric_limits<int64_t>::max());
  for (const std::string text : {"", "-1", "1.0", "9223372036854775808", "1e3", "x"}) {
    EXPECT_FALSE(ParseNonNegativeInteger(text).ok()) << text;
  }
}

}  // namespace
}  // namespace overtone
