// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/closure_judgement.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/closure_names.h"
#include "overtone/client/cli/closure_summary.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

// Keyframes at x = 0, 1, 2 and 20 m, heading along x; the last one's truth is unknown.
RobotPlan Plan(const std::string& name) {
  RobotPlan plan;
  plan.name = name;
  plan.id = {name, "run"};
  plan.common_from_world = Rigid3d::Identity();
  for (int i = 0; i < 3; ++i) {
    plan.ground_truth.push_back(Rigid3d(Eigen::Quaterniond::Identity(), {1.0 * i, 0, 0}));
  }
  plan.ground_truth.push_back(std::nullopt);
  for (const double x : {0, 1, 2, 20}) {
    // Odometry starts at a heading of its own.
    const Rigid3d mission_from_world(ExpSO3({0, 0, 1}), {3, 4, 0});
    Keyframe& keyframe = plan.keyframes.emplace_back();
    keyframe.mission_from_body = mission_from_world * Rigid3d(ExpSO3({0, 0, 0}), {x, 0, 0});
  }
  return plan;
}

LoopClosure Closure(const std::string& from, int i, const std::string& to, int j,
                    const Rigid3d& pose) {
  return {{{from, "run"}, i}, {{to, "run"}, j}, pose, Matrix6d::Identity()};
}

TEST(ClosureJudgement, AMeasurementIsRightWithinTheToleranceOfTheTrueRelativePose) {
  const std::vector<RobotPlan> plans = {Plan("a")};
  const ClosureTolerance tolerance = {0.5, 0.1, 1.5};
  const auto judge = [&](const Eigen::Vector3d& translation, double yaw) {
    return JudgeClosure(Closure("a", 0, "a", 2, {ExpSO3({0, 0, yaw}), translation}), true, plans,
                        tolerance);
  };
  const auto near = judge({2, 0.3, 0}, 0.05);
  ASSERT_TRUE(near.has_value());
  EXPECT_NEAR(*near->error_m, 0.3, 1e-12);
  EXPECT_NEAR(*near->error_rad, 0.05, 1e-12);
  EXPECT_NEAR(near->distance_m, 2, 1e-12);
  EXPECT_TRUE(near->right);
  EXPECT_TRUE(near->same_place);  // 2 m apart and 1.5 m allowed, but it was measured
  EXPECT_FALSE(judge({2, 0.6, 0}, 0)->same_place);
  EXPECT_FALSE(judge({2, 0.6, 0}, 0)->right);
  EXPECT_FALSE(judge({2, 0, 0}, 0.2)->right);
}

// As a corridor does along its axis.
TEST(ClosureJudgement, WhatAMeasurementLeavesOpenIsNotHeldAgainstIt) {
  LoopClosure closure = Closure("a", 0, "a", 2, {Eigen::Quaterniond::Identity(), {9, 0.1, 0}});
  EXPECT_FALSE(JudgeClosure(closure, true, {Plan("a")}, {})->right);
  closure.covariance(0, 0) = 1e4;
  const auto truth = JudgeClosure(closure, true, {Plan("a")}, {});
  EXPECT_TRUE(truth->right);
  EXPECT_NEAR(*truth->error_m, 0.1, 1e-9);
}

TEST(ClosureJudgement, TruthIsCarriedByOdometryFromANeighbourThatHasIt) {
  std::vector<RobotPlan> plans = {Plan("a")};
  plans[0].keyframes[3].mission_from_body =
      plans[0].keyframes[2].mission_from_body * Rigid3d(ExpSO3({0, 0, 0.5}), {1, 2, 0});
  const LoopClosure closure = Closure("a", 0, "a", 3, {ExpSO3({0, 0, 0.5}), {3, 2, 0}});
  const auto truth = JudgeClosure(closure, true, plans, {});
  ASSERT_TRUE(truth.has_value());
  EXPECT_NEAR(*truth->error_m, 0, 1e-9);
  EXPECT_NEAR(*truth->error_rad, 0, 1e-9);
}

TEST(ClosureJudgement, RobotsAreJudgedInTheFrameTheyShareOrNotAtAll) {
  std::vector<RobotPlan> plans = {Plan("a"), Plan("b")};
  plans[1].common_from_world = Rigid3d(Eigen::Quaterniond::Identity(), {0, 5, 0});
  const LoopClosure closure = Closure("a", 0, "b", 1, {Eigen::Quaterniond::Identity(), {1, 5, 0}});
  EXPECT_TRUE(JudgeClosure(closure, true, plans, {})->right);
  plans[1].common_from_world.reset();
  EXPECT_FALSE(JudgeClosure(closure, true, plans, {}).has_value());
  // Within a robot no common frame is needed.
  EXPECT_TRUE(JudgeClosure(Closure("b", 0, "b", 1, {}), true, plans, {}).has_value());
}

TEST(ClosureJudgement, WhatWasNotMeasuredIsNeverRightButMayBeThePlace) {
  const auto truth = JudgeClosure(Closure("a", 0, "a", 1, {}), false, {Plan("a")}, {});
  ASSERT_TRUE(truth.has_value());
  EXPECT_TRUE(truth->same_place);
  EXPECT_FALSE(truth->right);
  EXPECT_FALSE(truth->error_m.has_value());
  EXPECT_FALSE(JudgeClosure(Closure("a", 0, "a", 3, {}), false, {Plan("a")}, {}).has_value());
  EXPECT_FALSE(JudgeClosure(Closure("a", 0, "c", 0, {}), false, {Plan("a")}, {}).has_value());
}

TEST(ClosureJudgement, WherePositionsAloneAreKnownTheDistanceMustFit) {
  std::vector<RobotPlan> plans = {Plan("a")};
  plans[0].ground_truth_positions_only = true;
  const LoopClosure turned =
      Closure("a", 0, "a", 2, {ExpSO3({0, 0, 2}), Eigen::Vector3d(0, -1.9, 0)});
  const auto truth = JudgeClosure(turned, true, plans, {});
  ASSERT_TRUE(truth.has_value());
  EXPECT_NEAR(*truth->error_m, 0.1, 1e-12);
  EXPECT_FALSE(truth->error_rad.has_value());
  EXPECT_TRUE(truth->right);
}

TEST(ClosureJudgement, ToleranceIsReadFromText) {
  const auto tolerance = ParseClosureTolerance("rotation=0.5,place=3");
  ASSERT_TRUE(tolerance.ok());
  EXPECT_EQ(tolerance->translation_m, 1);
  EXPECT_EQ(tolerance->rotation_rad, 0.5);
  EXPECT_EQ(tolerance->place_m, 3);
  EXPECT_FALSE(ParseClosureTolerance("place=0").ok());
  EXPECT_FALSE(ParseClosureTolerance("colour=1").ok());
}

ClosureResult Row(const std::string& verdict, bool same_place, bool right) {
  ClosureResult row;
  row.proposer = "scan_context";
  row.verdict = verdict;
  row.truth = ClosureTruth();
  row.truth->same_place = same_place;
  row.truth->right = right;
  return row;
}

TEST(ClosureJudgement, PrecisionAndRecallCountWhatIsInUse) {
  RunResult result;
  for (int i = 0; i < 3; ++i) result.closures.push_back(Row("accepted", true, true));
  result.closures.push_back(Row("accepted", true, false));
  result.closures.push_back(Row("rejected_score", true, false));
  result.closures.push_back(Row("rejected_overlap", false, false));
  result.closures.push_back(Row("accepted", false, false));
  result.closures.back().truth.reset();  // nobody knows
  const ClosureScore score = ScoreClosures(result.closures).at("scan_context");
  EXPECT_EQ(score.proposed, 7);
  EXPECT_EQ(score.judged, 6);
  EXPECT_EQ(score.accepted, 5);
  EXPECT_EQ(score.accepted_wrong, 1);
  EXPECT_DOUBLE_EQ(*score.Precision(), 3.0 / 4);
  EXPECT_DOUBLE_EQ(*score.Recall(), 3.0 / 5);
  EXPECT_FALSE(ClosureScore().Precision().has_value());
  EXPECT_FALSE(ClosureScore().Recall().has_value());

  EXPECT_THAT(FormatClosures(result),
              HasSubstr("Loop closures by scan_context: 7 proposed, 5 in use; 5 accepted, 1 "
                        "rejected_overlap (0 of one place), 1 rejected_score (1 of one place)."));
  EXPECT_THAT(FormatClosures(result), HasSubstr("1 of 4 in use are wrong"));
  const Json json = ClosuresToJson(result);
  EXPECT_EQ(json.at("scan_context").at("accepted_wrong"), 1);
  EXPECT_EQ(json.at("scan_context").at("verdicts").at("rejected_score").at("same_place"), 1);
}

TEST(ClosureNames, AreThoseOfTheWire) {
  EXPECT_EQ(VerdictName(v1::LOOP_CLOSURE_VERDICT_DEMOTED_BY_OPTIMISER), "demoted_by_optimiser");
  EXPECT_EQ(VerdictName(v1::LOOP_CLOSURE_VERDICT_REJECTED_OVERLAP), "rejected_overlap");
  EXPECT_EQ(VerdictName(static_cast<v1::LoopClosureVerdict>(999)), "unspecified");
  EXPECT_EQ(ProposerName(v1::LOOP_CLOSURE_PROPOSER_SCAN_CONTEXT), "scan_context");
}

}  // namespace
}  // namespace overtone
