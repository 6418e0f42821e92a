// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/table.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/evaluation.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

TEST(Table, ColumnsAreAsWideAsTheirWidestCell) {
  EXPECT_EQ(FormatTable({{"robot", "n"}, {"a", "1000"}, {"long_name", "7"}}),
            "robot         n\n"
            "a          1000\n"
            "long_name     7\n");
}

Constraint Make(const std::string& id, ConstraintKind kind) {
  Constraint constraint;
  constraint.id = id;
  constraint.kind = kind;
  return constraint;
}

RunResult OneRobot() {
  RunResult result;
  result.closures_note = "Loop closures were SIMULATED.";
  RobotResult robot;
  robot.name = "MH_01";
  robot.path_m = 80.52;
  robot.graph_nodes = 201;
  robot.duration_s = 100;
  robot.bytes_up = 1'234'000;
  robot.bytes_down = 56'000;
  robot.server_error.emplace().rmse_m = 0.0152;
  robot.active_constraints = {Make("small:1-2", ConstraintKind::kSmall),
                              Make("mid:1-11", ConstraintKind::kMid),
                              Make("mid:2-12", ConstraintKind::kMid)};
  for (const double ms : {3.0, 1.0, 2.0}) {
    robot.comparisons.emplace_back().compare_ms = ms;
  }
  result.robots.push_back(robot);
  return result;
}

TEST(Table, ShowsWhatWasMeasuredAndADashForWhatWasNot) {
  const std::string text = FormatSummary(OneRobot());
  EXPECT_THAT(text, HasSubstr("robot  path [m]  nodes  onboard RMSE  server RMSE  corrected RMSE  "
                              "constraints s/m/l  up [KB/s]  down [KB/s]  compare p50/p99 [ms]\n"));
  EXPECT_THAT(text, HasSubstr("MH_01      80.5    201             -        0.015               -  "
                              "            1/2/0      12.34         0.56               2.0/3.0\n"));
  EXPECT_THAT(text, HasSubstr("Loop closures were SIMULATED."));
}

TEST(Table, ChordsAreCountedApart) {
  RunResult result = OneRobot();
  result.robots[0].active_constraints.push_back(Make("chord:0-50", ConstraintKind::kChord));
  EXPECT_THAT(FormatSummary(result), HasSubstr("1/2/0+1 chord"));
}

TEST(Evaluation, RetractedConstraintsAreNoLongerInForce) {
  Constraint moved = Make("mid:1-11", ConstraintKind::kMid);
  moved.revision = 7;
  const auto active = ActiveConstraints(
      {{ConstraintAction::kAdd, Make("small:1-2", ConstraintKind::kSmall), 20},
       {ConstraintAction::kAdd, Make("mid:1-11", ConstraintKind::kMid), 20},
       {ConstraintAction::kUpdate, moved, 40},
       {ConstraintAction::kRetract, Make("small:1-2", ConstraintKind::kSmall), 40}});
  ASSERT_EQ(active.size(), 1);
  EXPECT_EQ(active[0].id, "mid:1-11");
  EXPECT_EQ(active[0].revision, 7);
}

TEST(Evaluation, PosesWithoutGroundTruthAreLeftOut) {
  std::vector<Rigid3d> estimate;
  std::vector<std::optional<Rigid3d>> truth;
  for (int i = 0; i < 10; ++i) {
    const Rigid3d pose(Eigen::Quaterniond::Identity(), {double(i), double(i * i), 0});
    estimate.push_back(pose);
    truth.push_back(pose);
  }
  estimate[4].translation.x() += 100;  // would dominate
  truth[4].reset();
  const auto error = ErrorAgainst(estimate, truth);
  ASSERT_TRUE(error.has_value());
  EXPECT_LT(error->rmse_m, 1e-9);
  EXPECT_EQ(error->per_pose_m.size(), 9);
  EXPECT_FALSE(ErrorAgainst(estimate, {truth[0], truth[1]}).has_value());
}

}  // namespace
}  // namespace overtone
