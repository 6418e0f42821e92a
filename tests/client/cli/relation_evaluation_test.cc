// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/relation_evaluation.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/closure_summary.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

Rigid3d At(double x, double yaw = 0) { return {ExpSO3({0, 0, yaw}), {x, 0, 0}}; }

// Robots a and b, two keyframes each, 1 m apart in truth. Onboard stretches by `stretch`.
struct Team {
  std::vector<RobotPlan> plans = {RobotPlan(), RobotPlan()};
  std::vector<RobotResult> robots = {RobotResult(), RobotResult()};

  explicit Team(double stretch) {
    for (int i = 0; i < 2; ++i) {
      plans[i].id = {i == 0 ? "a" : "b", "run"};
      robots[i].onboard = {At(0), At(stretch)};
      robots[i].server = {At(10 * i), At(10 * i + 1)};
      robots[i].corrected = {At(0), At(1, 0.2)};
      robots[i].anchored = true;
    }
  }
};

TEST(RelationEvaluation, ErrorsAreThoseOfRelativePosesInTheEstimatesOwnFrame) {
  const Team team(1.5);
  const std::vector<LoopClosure> relations = {
      {{{"a", "run"}, 0}, {{"a", "run"}, 1}, At(1), Matrix6d::Identity()},
      {{{"a", "run"}, 1}, {{"a", "run"}, 0}, At(-1), Matrix6d::Identity()},
      {{{"a", "run"}, 0}, {{"b", "run"}, 0}, At(7), Matrix6d::Identity()}};
  const auto errors = EvaluateRelations(relations, team.plans, team.robots);
  ASSERT_EQ(errors.size(), 3);
  // Onboard knows nothing of another robot.
  EXPECT_EQ(errors[0].estimate, "onboard");
  EXPECT_EQ(errors[0].count, 2);
  EXPECT_NEAR(errors[0].translation_mean_m, 0.5, 1e-12);
  EXPECT_NEAR(errors[0].translation_median_m, 0.5, 1e-12);
  // The server does: 0, 0 and 3 m off.
  EXPECT_EQ(errors[1].estimate, "server");
  EXPECT_EQ(errors[1].count, 3);
  EXPECT_NEAR(errors[1].translation_mean_m, 1, 1e-12);
  EXPECT_NEAR(errors[1].translation_median_m, 0, 1e-12);
  EXPECT_EQ(errors[2].estimate, "corrected");
  EXPECT_NEAR(errors[2].rotation_median_rad, 0.2, 1e-12);
}

TEST(RelationEvaluation, RobotsThatAreNotTiedTogetherAreNotCompared) {
  Team team(1);
  team.robots[1].anchored = false;
  const std::vector<LoopClosure> relations = {
      {{{"a", "run"}, 0}, {{"b", "run"}, 0}, At(10), Matrix6d::Identity()}};
  const auto errors = EvaluateRelations(relations, team.plans, team.robots);
  EXPECT_EQ(errors[1].count, 0);
  RunResult result;
  result.relations = errors;
  EXPECT_TRUE(RelationsToJson(result).at("server").is_null());
  EXPECT_THAT(FormatRelations(result), HasSubstr("server"));
  EXPECT_TRUE(EvaluateRelations({}, team.plans, team.robots).empty());
}

}  // namespace
}  // namespace overtone
