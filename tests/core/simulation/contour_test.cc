// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/contour.h"

#include "gtest/gtest.h"

namespace overtone {
namespace {

std::vector<Segment> Contour(const std::array<double, 4>& values) {
  std::vector<Segment> segments;
  AppendContour(values, &segments);
  return segments;
}

double Linear(const Eigen::Vector2d& p) { return 0.3 * p.x() + p.y() - 0.5; }

TEST(Contour, OfALinearFunctionIsItsZeroLine) {
  const auto segments = Contour({Linear({0, 0}), Linear({1, 0}), Linear({1, 1}), Linear({0, 1})});
  ASSERT_EQ(segments.size(), 1u);
  for (const Eigen::Vector2d& end : {segments[0].begin, segments[0].end}) {
    EXPECT_NEAR(Linear(end), 0, 1e-15);
    EXPECT_TRUE(end.x() == 0 || end.x() == 1);  // it leaves by the left and the right edge
  }
  EXPECT_NE(segments[0].begin.x(), segments[0].end.x());
}

TEST(Contour, IsEmptyWhereTheSignDoesNotChangeAndZeroIsPositive) {
  EXPECT_TRUE(Contour({1, 2, 3, 4}).empty());
  EXPECT_TRUE(Contour({-1, -2, -3, -4}).empty());
  EXPECT_TRUE(Contour({0, 1, 0, 1}).empty());
  EXPECT_EQ(Contour({0, -1, -1, 0}).size(), 1u);
}

// Each negative corner is cut off by a segment of its own, in either diagonal.
TEST(Contour, OfASaddleKeepsTheNegativeCornersApart) {
  for (const bool odd : {false, true}) {
    const auto segments = odd ? Contour({1, -1, 1, -1}) : Contour({-1, 1, -1, 1});
    ASSERT_EQ(segments.size(), 2u);
    for (const Segment& segment : segments) {
      EXPECT_NEAR((segment.end - segment.begin).norm(), std::sqrt(0.5), 1e-15);
      const Eigen::Vector2d middle = (segment.begin + segment.end) / 2;
      EXPECT_EQ(middle.x() > 0.5, odd ? middle.y() < 0.5 : middle.y() > 0.5);
    }
  }
}

}  // namespace
}  // namespace overtone
