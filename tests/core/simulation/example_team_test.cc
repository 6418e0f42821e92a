// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/example_team.h"

#include <algorithm>
#include <limits>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/geometry/trajectory_error.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

std::vector<SimulatedRobot> Simulate(const ExampleTeamOptions& options) {
  const auto team = SimulateExampleTeam(options);
  EXPECT_TRUE(team.ok()) << team.status();
  return team.ok() ? *team : std::vector<SimulatedRobot>();
}

bool Equal(const Trajectory& a, const Trajectory& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const StampedPose& x, const StampedPose& y) {
                      return x.stamp == y.stamp && x.pose.translation == y.pose.translation &&
                             x.pose.rotation.coeffs() == y.pose.rotation.coeffs();
                    });
}

// The share of every tenth pose of `a` that has a pose of `b` within 1 m, at least min_gap poses
// away in order.
double ShareRevisited(const Trajectory& a, const Trajectory& b, int min_gap) {
  int revisited = 0, total = 0;
  for (int i = 0; i < static_cast<int>(a.size()); i += 10, ++total) {
    for (int j = 0; j < static_cast<int>(b.size()); j += 5) {
      if (std::abs(i - j) < min_gap) continue;
      if ((a[i].pose.translation - b[j].pose.translation).norm() < 1) {
        ++revisited;
        break;
      }
    }
  }
  return static_cast<double>(revisited) / total;
}

TEST(ExampleTeam, OneSeedGivesOneTeam) {
  const auto a = Simulate({});
  const auto b = Simulate({});
  ASSERT_EQ(a.size(), 3u);
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_TRUE(Equal(a[i].ground_truth, b[i].ground_truth));
    EXPECT_TRUE(Equal(a[i].odometry, b[i].odometry));
  }
}

TEST(ExampleTeam, AnotherSeedGivesAnotherTeam) {
  ExampleTeamOptions options;
  options.seed = 99;
  const auto a = Simulate({});
  const auto b = Simulate(options);
  EXPECT_FALSE(Equal(a[0].ground_truth, b[0].ground_truth));
  EXPECT_FALSE(Equal(a[0].odometry, b[0].odometry));
}

TEST(ExampleTeam, ARobotDoesNotDependOnHowManyOthersThereAre) {
  ExampleTeamOptions options;
  options.num_robots = 1;
  EXPECT_TRUE(Equal(Simulate(options)[0].odometry, Simulate({})[0].odometry));
}

TEST(ExampleTeam, EachRobotHasItsOwnNameStampsAndOdometryFrame) {
  const auto team = Simulate({});
  for (size_t i = 0; i < team.size(); ++i) {
    EXPECT_EQ(team[i].name, "robot_" + std::to_string(i + 1));
    ASSERT_EQ(team[i].odometry.size(), 6001u);
    ASSERT_EQ(team[i].ground_truth.size(), 6001u);
    EXPECT_EQ(Log(team[i].odometry[0].pose).norm(), 0);
    for (int k = 0; k < 6001; ++k) {
      EXPECT_EQ(team[i].odometry[k].stamp, team[i].ground_truth[k].stamp);
      if (k > 0) {
        EXPECT_EQ(team[i].odometry[k].stamp.ns - team[i].odometry[k - 1].stamp.ns, 100'000'000);
      }
    }
  }
}

TEST(ExampleTeam, RobotsDriveAFewHundredMetresSmoothly) {
  for (const SimulatedRobot& robot : Simulate({})) {
    const double path_m = PathLength(robot.ground_truth);
    EXPECT_GT(path_m, 300);
    EXPECT_LT(path_m, 400);
    for (size_t k = 2; k < robot.ground_truth.size(); ++k) {
      const Rigid3d& a = robot.ground_truth[k - 2].pose;
      const Rigid3d& b = robot.ground_truth[k - 1].pose;
      const Rigid3d& c = robot.ground_truth[k].pose;
      const Eigen::Vector3d acceleration =
          100 * (c.translation - 2 * b.translation + a.translation);
      EXPECT_LT(acceleration.norm(), 0.3) << robot.name << " pose " << k;      // m/s^2
      EXPECT_LT(10 * LogSO3(b.rotation.conjugate() * c.rotation).norm(), 1.0)  // rad/s
          << robot.name << " pose " << k;
    }
  }
}

TEST(ExampleTeam, TheRobotsAlsoClimb) {
  for (const SimulatedRobot& robot : Simulate({})) {
    double low = 0, high = 0;
    for (const StampedPose& pose : robot.ground_truth) {
      low = std::min(low, pose.pose.translation.z());
      high = std::max(high, pose.pose.translation.z());
    }
    EXPECT_GT(high - low, 1) << robot.name;
  }
}

TEST(ExampleTeam, EveryPairOfRobotsSharesStreetsAndEachRobotReturns) {
  const auto team = Simulate({});
  for (size_t i = 0; i < team.size(); ++i) {
    for (size_t j = 0; j < team.size(); ++j) {
      // Its own past counts from a minute on.
      const double share = ShareRevisited(team[i].ground_truth, team[j].ground_truth,
                                          /*min_gap=*/i == j ? 600 : 0);
      RecordProperty("share_" + team[i].name + "_" + team[j].name, std::to_string(share));
      EXPECT_GT(share, 0.2) << team[i].name << " " << team[j].name;
    }
  }
}

TEST(ExampleTeam, TheOdometryDriftsBySomeMetres) {
  for (const SimulatedRobot& robot : Simulate({})) {
    const auto error = AbsoluteTrajectoryError(Poses(robot.odometry), Poses(robot.ground_truth));
    ASSERT_TRUE(error.ok()) << error.status();
    RecordProperty("ate_" + robot.name, std::to_string(error->rmse_m));
    EXPECT_GT(error->rmse_m, 0.7) << robot.name;
    EXPECT_LT(error->rmse_m, 8) << robot.name;
  }
}

TEST(ExampleTeam, BadOptionsAreRefusedByName) {
  const auto message = [](auto set) {
    ExampleTeamOptions options;
    set(options);
    return std::string(SimulateExampleTeam(options).status().message());
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(message([](auto& o) { o.num_robots = 0; }), HasSubstr("num_robots"));
  EXPECT_THAT(message([&](auto& o) { o.duration_s = nan; }), HasSubstr("duration_s"));
  EXPECT_THAT(message([](auto& o) { o.rate_hz = 0; }), HasSubstr("rate_hz"));
  EXPECT_THAT(message([](auto& o) { o.speed_mps = -1; }), HasSubstr("speed_mps"));
  EXPECT_THAT(message([](auto& o) { o.odometry.scale_sigma = -1; }), HasSubstr("scale_sigma"));
  EXPECT_THAT(message([](auto& o) { o.duration_s = 86400, o.rate_hz = 1000; }),
              HasSubstr("num_robots"));
}

}  // namespace
}  // namespace overtone
