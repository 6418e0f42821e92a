// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/report_summary.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

// 100 comparisons of 1 to 100 ms, in no order: the 50th and the 99th by nearest rank.
TEST(SummaryRows, OneRobotByHand) {
  RobotResult robot;
  robot.name = "ant";
  robot.path_m = 123.44;
  robot.graph_nodes = 56;
  robot.onboard_error.emplace();
  robot.onboard_error->rmse_m = 1.2346;
  robot.corrected_error.emplace();
  robot.corrected_error->rmse_m = 0.1;
  robot.duration_s = 20;
  robot.bytes_up = 30'000;
  robot.bytes_down = 5'000;
  for (int i = 0; i < 100; ++i) {
    robot.comparisons.emplace_back();
    robot.comparisons.back().compare_ms = (i * 37) % 100 + 1;
  }
  robot.active_constraints.resize(6);
  robot.active_constraints[1].kind = ConstraintKind::kLarge;
  robot.active_constraints[2].kind = ConstraintKind::kLarge;
  robot.active_constraints[3].kind = ConstraintKind::kMid;
  robot.active_constraints[4].kind = ConstraintKind::kChord;
  RunResult result;
  result.robots = {robot};
  const auto rows = SummaryRows(result);
  ASSERT_THAT(rows, SizeIs(2));
  EXPECT_THAT(rows[0], SizeIs(10));
  EXPECT_THAT(rows[1], ElementsAre("ant", "123.4", "56", "1.235", "-", "0.100", "2/1/2+1 chord",
                                   "1.50", "0.25", "50.0/99.0"));
}

TEST(SummaryRows, ARobotThatDidNothing) {
  RunResult result;
  result.robots.resize(1);
  EXPECT_THAT(SummaryRows(result)[1],
              ElementsAre("", "0.0", "0", "-", "-", "-", "0/0/0", "-", "-", "-/-"));
}

}  // namespace
}  // namespace overtone
