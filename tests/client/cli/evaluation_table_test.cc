// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/evaluation_table.h"

#include <cmath>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

RobotResult MakeRobot(const std::string& name, int keyframes, double error_m) {
  RobotResult robot;
  robot.name = name;
  robot.path_m = 100;
  robot.stamps.resize(keyframes);
  TrajectoryError& error = robot.onboard_error.emplace();
  error.per_pose_m.assign(keyframes, error_m);
  error.rmse_m = error_m;
  return robot;
}

ClosureResult MakeClosure(const std::string& from, const std::string& to,
                          const std::string& verdict, bool right) {
  ClosureResult closure;
  closure.closure.from.mission.robot = from;
  closure.closure.to.mission.robot = to;
  closure.proposer = "scan_context";
  closure.verdict = verdict;
  closure.truth.emplace().right = right;
  return closure;
}

RunResult TwoRobots() {
  RunResult run;
  run.robots = {MakeRobot("a", 1, 5), MakeRobot("b", 3, 1)};
  run.robots[0].active_constraints.resize(2);
  run.robots[1].active_constraints.resize(1);
  run.closures = {MakeClosure("a", "b", "accepted", true), MakeClosure("a", "a", "accepted", false),
                  MakeClosure("b", "b", "rejected_overlap", true)};
  run.components = 1;
  run.wall_time_s = 12.34;
  return run;
}

TEST(EvaluationTable, ATeamsErrorIsThatOverTheKeyframesOfAll) {
  const auto rows = EvaluationRows("drift", TwoRobots());
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[2].robot, "team");
  EXPECT_DOUBLE_EQ(rows[2].onboard_rmse_m.value(), std::sqrt((25.0 + 3 * 1.0) / 4));
  EXPECT_FALSE(rows[2].server_rmse_m.has_value());
}

TEST(EvaluationTable, AClosureBetweenTwoRobotsCountsForBothAndForTheTeamOnce) {
  const auto rows = EvaluationRows("drift", TwoRobots());
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].closures_proposed, 2);
  EXPECT_EQ(rows[1].closures_proposed, 2);
  EXPECT_EQ(rows[2].closures_proposed, 3);
  EXPECT_EQ(rows[0].closures_in_use, 2);
  EXPECT_EQ(rows[1].closures_in_use, 1);
  EXPECT_EQ(rows[2].closures_in_use, 2);
  EXPECT_EQ(rows[0].closures_wrong, 1);
  EXPECT_EQ(rows[1].closures_wrong, 0);
  EXPECT_EQ(rows[2].closures_wrong, 1);
}

TEST(EvaluationTable, TheCsvHasAColumnForEachFigureAndNothingWhereNoneWasMeasured) {
  EXPECT_EQ(EvaluationCsv(EvaluationRows("drift", TwoRobots())),
            "experiment,robot,path_m,keyframes,onboard_rmse,server_rmse,corrected_rmse,"
            "closures_proposed,closures_in_use,closures_wrong_in_use,constraints,components,"
            "seconds\n"
            "drift,a,100.0,1,5.000,,,2,2,1,2,,\n"
            "drift,b,100.0,3,1.000,,,2,1,0,1,,\n"
            "drift,team,200.0,4,2.646,,,3,2,1,3,1,12.3\n");
}

TEST(EvaluationTable, ThePageSaysHowItWasMade) {
  EvaluationSuite suite;
  suite.name = "paper";
  suite.description = "The paper's experiments";
  suite.experiments = {{"drift", "two robots drift", nullptr}};
  const std::string page = EvaluationMarkdown(suite, 7, EvaluationRows("drift", TwoRobots()));
  EXPECT_THAT(page, HasSubstr("`overtone evaluate --suite paper --seed 7`"));
  EXPECT_THAT(page, HasSubstr("- **drift**: two robots drift.\n"));
  EXPECT_THAT(page,
              HasSubstr("| drift | b | 100.0 | 3 | 1.000 | - | - | 2 | 1 | 0 | 1 | - | - |\n"));
}

}  // namespace
}  // namespace overtone
