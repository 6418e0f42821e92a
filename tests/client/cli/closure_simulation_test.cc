// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/closure_simulation.h"

#include <cmath>
#include <map>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

constexpr int kPerLap = 100;  // keyframes, one each second, 1 m apart on a circle

// Drives `laps` times round the same circle.
RobotPlan Circle(const std::string& name, int laps) {
  RobotPlan plan;
  plan.name = name;
  plan.id = {name, "run"};
  plan.common_from_world = Rigid3d::Identity();
  const double radius = kPerLap / (2 * M_PI);
  for (int i = 0; i < laps * kPerLap; ++i) {
    const double angle = 2 * M_PI * i / kPerLap;
    const Rigid3d pose(ExpSO3({0.1, 0.2, angle}),
                       {radius * std::cos(angle), radius * std::sin(angle), 0});
    Keyframe keyframe;
    keyframe.stamp.ns = int64_t{i} * 1'000'000'000;
    keyframe.mission_from_body = pose;
    plan.keyframes.push_back(keyframe);
    plan.ground_truth.push_back(pose);
  }
  return plan;
}

ClosureSimulationOptions Options() {
  ClosureSimulationOptions options;
  options.radius_m = 0.5;
  options.max_per_keyframe = 3;
  return options;
}

Rigid3d TruePose(const std::vector<RobotPlan>& plans, const NodeId& node) {
  for (const RobotPlan& plan : plans) {
    if (plan.id == node.mission) return *plan.common_from_world * *plan.ground_truth[node.index];
  }
  return Rigid3d::Identity();
}

TEST(ClosureSimulation, EveryKeyframeOfTheSecondLapMeetsTheFirst) {
  const std::vector<RobotPlan> plans = {Circle("a", 2)};
  const auto closures = SimulateClosures(plans, Options());
  ASSERT_EQ(closures.size(), kPerLap);
  for (const SimulatedClosure& closure : closures) {
    EXPECT_EQ(closure.closure.to.index - closure.closure.from.index, kPerLap);
  }
}

TEST(ClosureSimulation, KeyframesOfOneMissionNearInTimeAreNoClosure) {
  ClosureSimulationOptions options = Options();
  options.radius_m = 3.5;
  options.min_gap_s = 1000;
  EXPECT_TRUE(SimulateClosures({Circle("a", 2)}, options).empty());
  options.min_gap_s = 10;
  for (const SimulatedClosure& closure : SimulateClosures({Circle("a", 2)}, options)) {
    EXPECT_GE(closure.closure.to.index - closure.closure.from.index, 10);
  }
}

TEST(ClosureSimulation, RobotsMeetOnlyWhereTheirGroundTruthsShareAFrame) {
  std::vector<RobotPlan> plans = {Circle("a", 1), Circle("b", 1)};
  EXPECT_EQ(SimulateClosures(plans, Options()).size(), kPerLap);
  plans[1].common_from_world.reset();
  EXPECT_TRUE(SimulateClosures(plans, Options()).empty());
}

TEST(ClosureSimulation, AnAlignmentBringsTheGroundTruthsTogether) {
  std::vector<RobotPlan> plans = {Circle("a", 1), Circle("b", 1)};
  const Rigid3d common_from_b(ExpSO3({0, 0, 1}), {100, -20, 3});
  plans[1].common_from_world = common_from_b;
  for (auto& pose : plans[1].ground_truth) pose = common_from_b.Inverse() * *pose;
  const auto closures = SimulateClosures(plans, Options());
  ASSERT_EQ(closures.size(), kPerLap);
  for (const SimulatedClosure& closure : closures) {
    const Rigid3d truth =
        TruePose(plans, closure.closure.from).Inverse() * TruePose(plans, closure.closure.to);
    EXPECT_LT(Log(truth.Inverse() * closure.closure.from_tform_to).norm(), 0.3);
  }
}

TEST(ClosureSimulation, TheNoiseHasTheStatedDeviationInEveryDirectionAndNoMean) {
  const std::vector<RobotPlan> plans = {Circle("a", 2), Circle("b", 30)};
  ClosureSimulationOptions options = Options();
  options.sigma_t_m = 0.05;
  options.sigma_r_rad = 0.02;
  const auto closures = SimulateClosures(plans, options);
  const int n = static_cast<int>(closures.size());
  ASSERT_GT(n, 5000);
  Vector6d sum = Vector6d::Zero(), squares = Vector6d::Zero();
  for (const SimulatedClosure& closure : closures) {
    const Rigid3d truth =
        TruePose(plans, closure.closure.from).Inverse() * TruePose(plans, closure.closure.to);
    const Vector6d error = Log(truth.Inverse() * closure.closure.from_tform_to);
    sum += error;
    squares += error.cwiseAbs2();
  }
  for (int i = 0; i < 6; ++i) {
    const double sigma = i < 3 ? 0.05 : 0.02;
    EXPECT_NEAR(std::sqrt(squares[i] / n), sigma, 0.05 * sigma) << "direction " << i;
    EXPECT_NEAR(sum[i] / n, 0, 5 * sigma / std::sqrt(n)) << "direction " << i;
    EXPECT_DOUBLE_EQ(closures[0].closure.covariance(i, i), sigma * sigma);
  }
}

TEST(ClosureSimulation, TheStatedShareIsWrong) {
  const std::vector<RobotPlan> plans = {Circle("a", 5)};
  ClosureSimulationOptions options = Options();
  options.outliers = 0.25;
  const auto closures = SimulateClosures(plans, options);
  int outliers = 0, far = 0;
  for (const SimulatedClosure& closure : closures) {
    const Rigid3d truth =
        TruePose(plans, closure.closure.from).Inverse() * TruePose(plans, closure.closure.to);
    const double error = Log(truth.Inverse() * closure.closure.from_tform_to).norm();
    outliers += closure.outlier;
    far += error > 0.5;
    EXPECT_TRUE(closure.outlier || error < 0.3);
  }
  EXPECT_EQ(outliers, std::lround(0.25 * closures.size()));
  EXPECT_GT(far, 0.98 * outliers);  // a random pose may happen to be right
}

TEST(ClosureSimulation, DensityIsTheShareOfKeyframesThatLook) {
  ClosureSimulationOptions options = Options();
  options.density = 0.2;
  options.max_per_keyframe = 1;
  const auto closures = SimulateClosures({Circle("a", 41)}, options);
  EXPECT_NEAR(closures.size(), 0.2 * 40 * kPerLap, 5 * std::sqrt(0.2 * 0.8 * 40 * kPerLap));
}

TEST(ClosureSimulation, NoKeyframeKeepsMoreThanItsLimit) {
  ClosureSimulationOptions options = Options();
  options.max_per_keyframe = 2;
  const auto closures =
      SimulateClosures({Circle("a", 1), Circle("b", 1), Circle("c", 1), Circle("d", 1)}, options);
  std::map<NodeId, int> count;
  for (const SimulatedClosure& closure : closures) ++count[closure.closure.to];
  int most = 0;
  for (const auto& [node, number] : count) most = std::max(most, number);
  EXPECT_EQ(most, 2);
}

TEST(ClosureSimulation, TheSeedDecides) {
  const std::vector<RobotPlan> plans = {Circle("a", 2)};
  ClosureSimulationOptions options = Options();
  options.outliers = 0.3;
  const auto first = SimulateClosures(plans, options);
  const auto again = SimulateClosures(plans, options);
  options.seed = 2;
  const auto other = SimulateClosures(plans, options);
  ASSERT_EQ(first.size(), again.size());
  double same = 0, different = 0;
  for (size_t i = 0; i < first.size(); ++i) {
    same +=
        (first[i].closure.from_tform_to.translation - again[i].closure.from_tform_to.translation)
            .norm();
    different +=
        (first[i].closure.from_tform_to.translation - other[i].closure.from_tform_to.translation)
            .norm();
  }
  EXPECT_EQ(same, 0);
  EXPECT_GT(different, 0);
}

TEST(ClosureSimulation, KeyframesWithoutGroundTruthAreLeftOut) {
  std::vector<RobotPlan> plans = {Circle("a", 2)};
  for (int i = 0; i < 50; ++i) plans[0].ground_truth[i].reset();
  EXPECT_EQ(SimulateClosures(plans, Options()).size(), kPerLap - 50);
}

TEST(ClosureSimulation, TheRuleIsReadFromTextAndSaidInWords) {
  const auto options =
      ParseClosureSimulation("radius=2,sigma_t=0.1,sigma_r=0.01,outliers=0.2,density=0.5,seed=7");
  ASSERT_TRUE(options.ok()) << options.status();
  EXPECT_EQ(options->radius_m, 2);
  EXPECT_EQ(options->outliers, 0.2);
  const std::string words = Describe(*options);
  EXPECT_THAT(words, HasSubstr("SIMULATED from ground truth"));
  EXPECT_THAT(words, HasSubstr("within 2 m"));
  EXPECT_THAT(words, HasSubstr("20 % replaced by random wrong poses"));
  EXPECT_THAT(words, HasSubstr("50 % of the keyframes"));
}

TEST(ClosureSimulation, WrongRulesAreRefusedByName) {
  for (const auto& [text, name] : std::map<std::string, std::string>{{"radius=0", "radius"},
                                                                     {"radius=nan", "radius"},
                                                                     {"sigma_t=-1", "sigma_t"},
                                                                     {"sigma_r=inf", "sigma_r"},
                                                                     {"outliers=1", "outliers"},
                                                                     {"density=0", "density"},
                                                                     {"radius", "radius"},
                                                                     {"colour=3", "colour"}}) {
    const auto options = ParseClosureSimulation(text);
    EXPECT_EQ(options.status().code(), absl::StatusCode::kInvalidArgument) << text;
    EXPECT_THAT(std::string(options.status().message()), HasSubstr(name)) << text;
  }
}

}  // namespace
}  // namespace overtone
