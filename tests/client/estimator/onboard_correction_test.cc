// SPDX-License-Identifier: Apache-2.0
// The robot's whole pass without the network: compare, select, reconcile, apply.
#include <random>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/estimator/onboard_estimator.h"
#include "overtone/core/geometry/trajectory_error.h"
#include "overtone/core/synchronization/constraint_history.h"
#include "overtone/core/synchronization/constraint_selection.h"
#include "overtone/core/synchronization/wavelet_discrepancy.h"

namespace overtone {
namespace {

const MissionId kMission = {"robot", "mission"};
constexpr int kNumNodes = 200;

// Two rounds of a 12 m by 6 m ellipse with waves, and odometry that drifts along it.
struct Mission {
  std::vector<Rigid3d> truth;
  OnboardEstimator estimator;

  explicit Mission(int seed) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    Vector6d sigma;
    sigma << Eigen::Vector3d::Constant(0.02), Eigen::Vector3d::Constant(0.01);
    const Matrix6d covariance = sigma.cwiseAbs2().asDiagonal();
    for (int i = 0; i < kNumNodes; ++i) {
      const double t = 4 * M_PI * i / kNumNodes;
      truth.emplace_back(ExpSO3({0, 0, t}),
                         Eigen::Vector3d(12 * std::cos(t), 6 * std::sin(t), 0.5 * std::sin(3 * t)));
      const Vector6d noise = Vector6d::NullaryExpr([&] { return normal(random); });
      const Rigid3d motion =
          i == 0 ? Rigid3d() : truth[i - 1].Inverse() * truth[i] * Exp(sigma.cwiseProduct(noise));
      EXPECT_TRUE(estimator.AddKeyframe(i, {i}, motion, covariance).ok());
    }
  }

  MapGraph ServerGraph() const {
    MapMission mission;
    mission.id = kMission;
    for (int i = 0; i < kNumNodes; ++i) mission.nodes.push_back({i, {i}, truth[i], i % 20 == 0});
    MapGraph graph;
    graph.missions = {mission};
    return graph;
  }

  double Rmse() {
    std::vector<Rigid3d> estimate;
    for (const OnboardPose& node : estimator.Trajectory()) {
      estimate.push_back(node.estimate_from_body);
    }
    return AbsoluteTrajectoryError(estimate, truth)->rmse_m;
  }
};

ConstraintBatch Synchronize(Mission& mission, const SynchronizationOptions& options,
                            ConstraintHistory& history) {
  const auto comparison =
      CompareTrajectories(mission.ServerGraph(), kMission, mission.estimator.Trajectory(), options);
  EXPECT_TRUE(comparison.ok()) << comparison.status();
  const ConstraintBatch batch =
      history.Reconcile(SelectConstraints(*comparison, options), *comparison, options.constraints);
  const absl::Status status = mission.estimator.ApplyConstraints(batch);
  EXPECT_TRUE(status.ok()) << status;
  history.Commit(batch);
  return batch;
}

SynchronizationOptions Options(SelectionStrategy strategy, int n) {
  SynchronizationOptions options;
  options.selection.strategy = strategy;
  options.selection.n = n;
  return options;
}

double RatioAfter(SelectionStrategy strategy, int n, int rounds, int seed) {
  Mission mission(seed);
  ConstraintHistory history;
  const double before = mission.Rmse();
  for (int round = 0; round < rounds; ++round) {
    Synchronize(mission, Options(strategy, n), history);
  }
  return mission.Rmse() / before;
}

TEST(OnboardCorrection, UniformChordsBringADriftedRunToTheServers) {
  for (const int seed : {1, 2, 3}) {
    EXPECT_LT(RatioAfter(SelectionStrategy::kUniform, 8, 1, seed), 0.5) << "seed " << seed;
    EXPECT_LT(RatioAfter(SelectionStrategy::kUniform, 50, 1, seed), 0.3) << "seed " << seed;
  }
}

// On smooth drift the largest 15 entries gain little: their constraints lie side by side.
TEST(OnboardCorrection, RepeatedTopNComparisonsLowerTheError) {
  for (const int seed : {1, 2, 3}) {
    EXPECT_LT(RatioAfter(SelectionStrategy::kTopN, 15, 8, seed), 1) << "seed " << seed;
    EXPECT_LT(RatioAfter(SelectionStrategy::kTopN, 100, 2, seed), 0.6) << "seed " << seed;
  }
}

TEST(OnboardCorrection, EveryStepOfTheServersBringsTheRunToTheTruth) {
  Mission mission(4);
  ConstraintHistory history;
  SynchronizationOptions options = Options(SelectionStrategy::kAll, 1);
  options.constraints.sigma_translation_m = options.constraints.sigma_rotation_rad = 1e-6;
  EXPECT_EQ(Synchronize(mission, options, history).add.size(), kNumNodes - 1);
  EXPECT_LT(mission.Rmse(), 1e-4);
  // Server and robot agree: nothing is left to say, neither to the history nor to the wavelets.
  EXPECT_TRUE(Synchronize(mission, options, history).empty());
  EXPECT_TRUE(Synchronize(mission, Options(SelectionStrategy::kTopN, 15), history).empty());
}

}  // namespace
}  // namespace overtone
