// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/scenario.h"

#include <algorithm>
#include <limits>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

constexpr OdometryNoise kNoNoise = {0, 0, 0, 0, 0};

Scenario Simulate(const ScenarioOptions& options) {
  auto scenario = SimulateScenario(options);
  EXPECT_TRUE(scenario.ok()) << scenario.status();
  return *std::move(scenario);
}

ScenarioOptions Of(const std::string& scene) {
  ScenarioOptions options;
  options.scene = scene;
  return options;
}

// Every pose, not keyframes only.
ScenarioOptions Dense(ScenarioOptions options) {
  options.keyframes = {0, 0};
  return options;
}

void ExpectSame(const Trajectory& a, const Trajectory& b, double tolerance) {
  ASSERT_EQ(a.size(), b.size());
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].stamp, b[i].stamp);
    EXPECT_LE(Log(a[i].pose.Inverse() * b[i].pose).norm(), tolerance) << i;
  }
}

// The share of `a` that has a pose of `b` within 2 m.
double ShareNear(const Trajectory& a, const Trajectory& b) {
  const auto near = std::count_if(a.begin(), a.end(), [&b](const StampedPose& x) {
    return std::any_of(b.begin(), b.end(), [&x](const StampedPose& y) {
      return (x.pose.translation - y.pose.translation).norm() < 2;
    });
  });
  return static_cast<double>(near) / static_cast<double>(a.size());
}

TEST(Scenario, NoPoseComesWithinThirtyCentimetresOfASurface) {
  for (const std::string& name : SceneNames()) {
    for (const bool explore : {false, true}) {
      for (uint64_t seed = 1; seed <= 3; ++seed) {
        ScenarioOptions options = Dense(Of(name));
        options.explore = explore;
        options.num_robots = 5;
        options.seed = seed;
        const Scenario scenario = Simulate(options);
        for (const ScenarioRobot& robot : scenario.robots) {
          for (const StampedPose& pose : robot.ground_truth) {
            ASSERT_GT(scenario.world.DistanceToSurface(pose.pose.translation, 1), 0.3)
                << name << " seed " << seed << " " << robot.name << " at "
                << pose.pose.translation.transpose();
          }
        }
      }
    }
  }
}

TEST(Scenario, RobotsDriveSmoothlyUprightAndAtTheirSpeed) {
  for (const std::string& name : SceneNames()) {
    for (const ScenarioRobot& robot : Simulate(Dense(Of(name))).robots) {
      const Trajectory& truth = robot.ground_truth;
      for (size_t i = 1; i + 1 < truth.size(); ++i) {
        const double dt = SecondsBetween(truth[i - 1].stamp, truth[i].stamp);
        const Rigid3d motion = truth[i - 1].pose.Inverse() * truth[i].pose;
        EXPECT_LT(motion.translation.norm() / dt, 1.5) << name;
        EXPECT_LT(LogSO3(motion.rotation).norm() / dt, 2.5) << name;  // rad/s, round a corner
        EXPECT_GT((truth[i].pose.rotation * Eigen::Vector3d::UnitZ()).z(), 0.95) << name;
      }
      const double duration_s = SecondsBetween(truth.front().stamp, truth.back().stamp);
      EXPECT_NEAR(PathLength(truth) / duration_s, 1, 0.1) << name;
    }
  }
}

TEST(Scenario, EveryPairOfTheScriptedTeamVisitsCommonPlaces) {
  for (const std::string& name : SceneNames()) {
    const Scenario scenario = Simulate(Of(name));
    EXPECT_EQ(scenario.robots.size(), scenario.scene.routes.size());
    for (const ScenarioRobot& a : scenario.robots) {
      for (const ScenarioRobot& b : scenario.robots) {
        if (&a == &b) continue;
        const double share = ShareNear(a.ground_truth, b.ground_truth);
        RecordProperty(name + "_" + a.name + "_" + b.name, std::to_string(share));
        EXPECT_GT(share, 0.1) << name << " " << a.name << " " << b.name;
      }
    }
  }
}

TEST(Scenario, OneSeedGivesOneScenarioDownToThePoints) {
  const Scenario a = Simulate({}), b = Simulate({});
  ScenarioOptions other;
  other.seed = 2;
  const Scenario c = Simulate(other);
  const auto lidar = Lidar::Create({});
  ASSERT_TRUE(lidar.ok());
  for (size_t i = 0; i < a.robots.size(); ++i) {
    ExpectSame(a.robots[i].odometry, b.robots[i].odometry, 0);
    ExpectSame(a.robots[i].ground_truth, b.robots[i].ground_truth, 0);
    const PointCloud cloud = a.robots[i].Scan(a.world, *lidar, 5);
    EXPECT_EQ(cloud.points, b.robots[i].Scan(b.world, *lidar, 5).points);
    EXPECT_NE(cloud.points, c.robots[i].Scan(c.world, *lidar, 5).points);
    EXPECT_NE(cloud.points, a.robots[i].Scan(a.world, *lidar, 6).points);
  }
}

TEST(Scenario, NoiseDiffersFromScanToScanOfOnePlace) {
  Scenario scenario = Simulate({});
  ScenarioRobot& robot = scenario.robots[0];
  robot.ground_truth[6].pose = robot.ground_truth[5].pose;
  const auto lidar = Lidar::Create({});
  ASSERT_TRUE(lidar.ok());
  EXPECT_NE(robot.Scan(scenario.world, *lidar, 5).points,
            robot.Scan(scenario.world, *lidar, 6).points);
}

TEST(Scenario, WithoutNoiseOdometryIsTheTruthFromItsFirstPose) {
  ScenarioOptions options;
  options.odometry = kNoNoise;
  for (const ScenarioRobot& robot : Simulate(options).robots) {
    const Rigid3d odometry_from_world = robot.ground_truth[0].pose.Inverse();
    Trajectory expected = robot.ground_truth;
    for (StampedPose& pose : expected) pose.pose = odometry_from_world * pose.pose;
    ExpectSame(robot.odometry, expected, 1e-9);
  }
}

TEST(Scenario, OdometryStartsAtIdentityAndDriftsByAboutOnePerCent) {
  double drift = 0, length = 0;
  for (uint64_t seed = 1; seed <= 5; ++seed) {
    ScenarioOptions options;
    options.seed = seed;
    for (const ScenarioRobot& robot : Simulate(options).robots) {
      EXPECT_EQ(Log(robot.odometry[0].pose).norm(), 0);
      const Rigid3d moved =
          robot.ground_truth.front().pose.Inverse() * robot.ground_truth.back().pose;
      drift += (robot.odometry.back().pose.translation - moved.translation).norm();
      length += PathLength(robot.ground_truth);
    }
  }
  EXPECT_GT(drift / length, 0.002);
  EXPECT_LT(drift / length, 0.02);
}

TEST(Scenario, KeyframesAreTheWantedDistanceApart) {
  ScenarioOptions options;
  options.keyframes = {2, 10};
  for (const ScenarioRobot& robot : Simulate(options).robots) {
    for (size_t i = 1; i + 1 < robot.ground_truth.size(); ++i) {
      const double distance =
          (robot.ground_truth[i].pose.translation - robot.ground_truth[i - 1].pose.translation)
              .norm();
      EXPECT_GE(distance, 2);
      EXPECT_LT(distance, 2.15);  // a step of a tenth of a second
    }
  }
}

TEST(Scenario, LengthsAreAsWantedBeyondAndWithinTheRouteAndForManyRobots) {
  for (const double length_m : {60.0, 700.0}) {
    ScenarioOptions options;
    options.length_m = length_m;
    options.num_robots = 20;
    const Scenario scenario = Simulate(options);
    ASSERT_EQ(scenario.robots.size(), 20u);
    EXPECT_EQ(scenario.robots[19].name, "robot20");
    for (const ScenarioRobot& robot : scenario.robots) {
      EXPECT_NEAR(PathLength(robot.ground_truth), length_m, 0.1 * length_m) << robot.name;
    }
  }
}

TEST(Scenario, FailuresAreThoseOfTheFirstRobotsWhenOnlySoManyFail) {
  ScenarioOptions options;
  options.scene = "corridor";
  options.failures.degenerate = true;
  options.num_failing = 1;
  const Scenario scenario = Simulate(options);
  ASSERT_EQ(scenario.robots.size(), 2u);
  EXPECT_FALSE(scenario.robots[0].degenerate.empty());
  EXPECT_TRUE(scenario.robots[1].degenerate.empty());
  const auto measured_share = [](const ScenarioRobot& robot) {
    return PathLength(robot.odometry) / PathLength(robot.ground_truth);
  };
  EXPECT_LT(measured_share(scenario.robots[0]), 0.95);
  EXPECT_NEAR(measured_share(scenario.robots[1]), 1, 0.02);
}

TEST(Scenario, BadOptionsAreRefusedByName) {
  const auto message = [](auto set) {
    ScenarioOptions options;
    set(options);
    return std::string(SimulateScenario(options).status().message());
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message([](auto& o) { o.scene = "moon"; }), HasSubstr("moon"));
  EXPECT_THAT(message([](auto& o) { o.num_robots = 101; }), HasSubstr(".num_robots"));
  EXPECT_THAT(message([](auto& o) { o.num_failing = -1; }), HasSubstr(".num_failing"));
  EXPECT_THAT(message([](auto& o) { o.length_m = -1; }), HasSubstr(".length_m"));
  EXPECT_THAT(message([](auto& o) { o.speed_mps = 0; }), HasSubstr(".speed_mps"));
  EXPECT_THAT(message([](auto& o) { o.rate_hz = 0; }), HasSubstr(".rate_hz"));
  EXPECT_THAT(message([](auto& o) { o.body_height_m = 3; }), HasSubstr(".body_height_m"));
  EXPECT_THAT(message([&](auto& o) { o.keyframes.min_distance_m = nan; }),
              HasSubstr("min_distance_m"));
  EXPECT_THAT(message([](auto& o) { o.odometry.scale_sigma = -1; }), HasSubstr("scale_sigma"));
  EXPECT_THAT(message([](auto& o) { o.failures.motion_share = 3; }), HasSubstr(".motion_share"));
  EXPECT_THAT(message([](auto& o) { o.failures.yaw_drift = true; }),
              HasSubstr(".yaw_drift: scene tunnel has no terrace"));
  EXPECT_THAT(message([](auto& o) { o.failures.degenerate = true; }),
              HasSubstr(".degenerate: scene tunnel has no corridor"));
}

}  // namespace
}  // namespace overtone
