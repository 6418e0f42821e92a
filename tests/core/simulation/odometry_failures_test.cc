// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/odometry_failures.h"

#include <cmath>
#include <limits>
#include <set>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/simulation/scenario.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

// Noise-free, every pose a keyframe.
Scenario Simulate(const std::string& scene, const OdometryFailures& failures) {
  ScenarioOptions options;
  options.scene = scene;
  options.odometry = {0, 0, 0, 0, 0};
  options.keyframes = {0, 0};
  options.failures = failures;
  auto scenario = SimulateScenario(options);
  EXPECT_TRUE(scenario.ok()) << scenario.status();
  return *std::move(scenario);
}

Rigid3d Motion(const Trajectory& trajectory, size_t step) {
  return trajectory[step - 1].pose.Inverse() * trajectory[step].pose;
}

TEST(OdometryFailures, YawDriftsOnTheTerraceAndNowhereElse) {
  OdometryFailures failures;
  failures.yaw_drift = true;
  failures.yaw_rate_rps = 0.01;
  const Scenario scenario = Simulate("terrace", failures);
  int on_terrace = 0, elsewhere = 0;
  for (const ScenarioRobot& robot : scenario.robots) {
    for (size_t i = 1; i < robot.odometry.size(); ++i) {
      const Vector6d error =
          Log(Motion(robot.ground_truth, i).Inverse() * Motion(robot.odometry, i));
      const Eigen::Vector2d from = robot.ground_truth[i - 1].pose.translation.head<2>();
      const bool inside = scenario.scene.terrace->contains(from);
      (inside ? on_terrace : elsewhere)++;
      EXPECT_NEAR(error[5], inside ? 0.001 : 0, 1e-9);  // 0.01 rad/s for 0.1 s
      EXPECT_NEAR(error.head<5>().norm(), 0, 1e-9);
    }
  }
  EXPECT_GT(on_terrace, 1000);
  EXPECT_GT(elsewhere, 1000);
}

TEST(OdometryFailures, TheCorridorShortensMotionAlongItselfAndNothingElse) {
  OdometryFailures failures;
  failures.degenerate = true;
  const Scenario scenario = Simulate("corridor", failures);
  int flagged = 0, others = 0;
  for (const ScenarioRobot& robot : scenario.robots) {
    std::set<int> degenerate;
    for (const auto& [index, direction] : robot.degenerate) {
      degenerate.insert(index);
      // The direction that is named is the corridor's, seen from the body.
      EXPECT_NEAR(
          (robot.ground_truth[index].pose.rotation * direction - Eigen::Vector3d::UnitX()).norm(),
          0, 1e-12);
    }
    for (size_t i = 1; i < robot.odometry.size(); ++i) {
      const Eigen::Quaterniond& world_from_body = robot.ground_truth[i - 1].pose.rotation;
      const Rigid3d is = Motion(robot.odometry, i), should = Motion(robot.ground_truth, i);
      const Eigen::Vector3d measured = world_from_body * is.translation;
      const Eigen::Vector3d moved = world_from_body * should.translation;
      const bool in_corridor = degenerate.count(static_cast<int>(i)) > 0;
      (in_corridor ? flagged : others)++;
      EXPECT_NEAR(measured.x(), (in_corridor ? 0.7 : 1) * moved.x(), 1e-9);
      EXPECT_NEAR((measured - moved).tail<2>().norm(), 0, 1e-9);
      EXPECT_NEAR(LogSO3(should.rotation.conjugate() * is.rotation).norm(), 0, 1e-9);
      const Eigen::Vector2d from = robot.ground_truth[i - 1].pose.translation.head<2>();
      EXPECT_EQ(in_corridor, scenario.scene.corridor->contains(from));
    }
  }
  EXPECT_GT(flagged, 1000);
  EXPECT_GT(others, 1000);
}

// Between sparse keyframes the motion may only pass through: both its ends outside, still flagged.
TEST(OdometryFailures, AKeyframeIsFlaggedForTheMotionThatLeadsToIt) {
  ScenarioOptions options;
  options.scene = "corridor";
  options.failures.degenerate = true;
  options.keyframes = {80, 100};
  const auto scenario = SimulateScenario(options);
  ASSERT_TRUE(scenario.ok());
  for (const ScenarioRobot& robot : scenario->robots) {
    ASSERT_FALSE(robot.degenerate.empty());
    std::set<int> degenerate;
    for (const DegenerateKeyframe& keyframe : robot.degenerate) degenerate.insert(keyframe.index);
    EXPECT_EQ(degenerate.count(0), 0u);
    for (size_t i = 1; i < robot.ground_truth.size(); ++i) {
      const double a = robot.ground_truth[i - 1].pose.translation.x();
      const double b = robot.ground_truth[i].pose.translation.x();
      const bool crosses = std::min(a, b) < 112 && std::max(a, b) > 50;
      EXPECT_EQ(degenerate.count(static_cast<int>(i)) > 0, crosses) << a << " to " << b;
    }
  }
}

TEST(OdometryFailures, AJumpHappensOnceNearTheMiddleAndHasTheStatedSize) {
  OdometryFailures failures;
  failures.jump = true;
  const Scenario scenario = Simulate("tunnel", failures);
  for (const ScenarioRobot& robot : scenario.robots) {
    int jumps = 0;
    for (size_t i = 1; i < robot.odometry.size(); ++i) {
      const Rigid3d error = Motion(robot.ground_truth, i).Inverse() * Motion(robot.odometry, i);
      if (Log(error).norm() < 1e-9) continue;
      ++jumps;
      EXPECT_NEAR(error.translation.norm(), 1.5, 1e-9);
      EXPECT_NEAR(LogSO3(error.rotation).z(), 0.15, 1e-9);
      const double when = static_cast<double>(i) / static_cast<double>(robot.odometry.size());
      EXPECT_TRUE(when > 0.39 && when < 0.61) << when;
    }
    EXPECT_EQ(jumps, 1) << robot.name;
  }
}

TEST(OdometryFailures, FailuresShiftNeitherTheWaysNorTheNoise) {
  ScenarioOptions options;
  options.scene = "corridor";
  const auto without = SimulateScenario(options);
  options.failures.degenerate = true;
  const auto with = SimulateScenario(options);
  ASSERT_TRUE(without.ok() && with.ok());
  for (size_t r = 0; r < with->robots.size(); ++r) {
    const ScenarioRobot &a = without->robots[r], &b = with->robots[r];
    EXPECT_TRUE(a.degenerate.empty());
    ASSERT_EQ(a.ground_truth.size(), b.ground_truth.size());
    EXPECT_EQ(a.scan_seed, b.scan_seed);
    for (int i = 1; i < b.degenerate.front().index; ++i) {
      EXPECT_EQ(Log(Motion(a.odometry, i).Inverse() * Motion(b.odometry, i)).norm(), 0);
    }
  }
}

TEST(OdometryFailures, DefaultsAreValidAndBadMembersAreNamed) {
  EXPECT_TRUE(OdometryFailures().Validate().ok());
  const auto message = [](auto set) {
    OdometryFailures failures;
    set(failures);
    return std::string(failures.Validate().message());
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message([&](auto& f) { f.yaw_rate_rps = nan; }), HasSubstr(".yaw_rate_rps"));
  EXPECT_THAT(message([](auto& f) { f.motion_share = -0.1; }), HasSubstr(".motion_share"));
  EXPECT_THAT(message([](auto& f) { f.jump_m = -1; }), HasSubstr(".jump_m"));
  EXPECT_THAT(message([](auto& f) { f.jump_yaw_rad = 4; }), HasSubstr(".jump_yaw_rad"));
}

}  // namespace
}  // namespace overtone
