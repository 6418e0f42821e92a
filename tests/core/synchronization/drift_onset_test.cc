// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/drift_onset.h"

#include <algorithm>
#include <iostream>

#include "gtest/gtest.h"
#include "overtone/core/synchronization/chord_selection.h"
#include "overtone/core/synchronization/discrepancy_labels.h"
#include "overtone/core/synchronization/wavelet_discrepancy.h"
#include "overtone/tests/support/drifting_mission.h"

namespace overtone {
namespace {

constexpr int kNumNodes = 300;

// Ordinary noise, and from `onset` on a heading that turns by `bias_rad` too much in every step.
DriftingMission MissionWithOnset(int seed, int onset, double bias_rad) {
  DriftingMission mission = MakeDriftingMission(kNumNodes, seed, 0.01, 0.002);
  for (int i = onset + 1; i < kNumNodes; ++i) {
    mission.Slip(i, Rigid3d(ExpSO3({0, 0, bias_rad}), Eigen::Vector3d::Zero()));
  }
  return mission;
}

TrajectoryComparison Compare(const DriftingMission& mission, SignalKind signal) {
  MapMission server;
  server.id = {"robot", "mission"};
  std::vector<NodePose> onboard;
  for (int i = 0; i < kNumNodes; ++i) {
    server.nodes.push_back({i, {i}, mission.truth[i], i % 20 == 0});
    onboard.push_back({i, {i}, mission.odometry[i]});
  }
  MapGraph graph;
  graph.missions = {server};
  SynchronizationOptions options;
  options.signal = signal;
  const auto comparison = CompareTrajectories(graph, server.id, onboard, options);
  EXPECT_TRUE(comparison.ok()) << comparison.status();
  return *comparison;
}

double Median(std::vector<int> errors) {
  std::sort(errors.begin(), errors.end());
  return errors[errors.size() / 2];
}

TEST(FindDriftOnset, FindsInjectedOnsetsNearerThanLabelsAndLargestSteps) {
  std::vector<int> onset_errors, top_n_errors, edge_errors;
  for (int seed = 1; seed <= 21; ++seed) {
    const int onset = 40 + 10 * seed;
    const DriftingMission mission = MissionWithOnset(seed, onset, 0.003);
    const TrajectoryComparison comparison = Compare(mission, SignalKind::kDistance);
    const auto found =
        FindDriftOnset(comparison, SynchronizationOptions(), {{}, mission.step_covariance, {}});
    ASSERT_TRUE(found.has_value()) << "seed " << seed;
    onset_errors.push_back(std::abs(found->row - onset));
    EXPECT_EQ(found->keyframe_index, found->row);
    const auto labels = LargestDiscrepancies(comparison.discrepancy, 15, 0);
    top_n_errors.push_back(std::abs(labels.front().node - onset));
    SynchronizationOptions options;
    options.selection.n = 1;
    edge_errors.push_back(
        std::abs(static_cast<int>(LargestEdgeErrors(comparison, options)[0].from) - onset));
  }
  RecordProperty("median_nodes_onset", static_cast<int>(Median(onset_errors)));
  RecordProperty("median_nodes_top_n", static_cast<int>(Median(top_n_errors)));
  RecordProperty("median_nodes_largest_edge_error", static_cast<int>(Median(edge_errors)));
  std::cout << "median error in nodes: onset " << Median(onset_errors) << ", first of top_n "
            << Median(top_n_errors) << ", largest_edge_error " << Median(edge_errors) << "\n";
  EXPECT_LE(Median(onset_errors), 4);
  EXPECT_LT(Median(onset_errors), Median(top_n_errors));
  EXPECT_LT(Median(onset_errors), Median(edge_errors));
}

TEST(FindDriftOnset, ARobotWithOrdinaryDriftHasNone) {
  int found = 0;
  for (int seed = 1; seed <= 20; ++seed) {
    const DriftingMission mission = MakeDriftingMission(kNumNodes, seed, 0.01, 0.002);
    // Whatever its covariances claim.
    for (const double claimed : {0.1, 1.0, 10.0}) {
      SelectionContext context = {{}, mission.step_covariance, {}};
      for (Matrix6d& covariance : context.step_covariance) covariance *= claimed;
      found += FindDriftOnset(ComparisonOf(mission), SynchronizationOptions(), context).has_value();
    }
  }
  EXPECT_EQ(found, 0);
}

TEST(FindDriftOnset, ASlipIsAStretchOfOneStep) {
  DriftingMission mission = MakeDriftingMission(kNumNodes, 3, 0.01, 0.002);
  mission.Slip(137, Rigid3d(ExpSO3({0, 0, 0.1}), Eigen::Vector3d(0.5, 0, 0)));
  const auto found = FindDriftOnset(Compare(mission, SignalKind::kSe3Log), SynchronizationOptions(),
                                    {{}, mission.step_covariance, {}});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->row, 136);
  EXPECT_EQ(found->end_row, 137);
}

TEST(FindDriftOnset, ALongMissionIsSearchedCoarselyAndThenOneByOne) {
  DriftingMission mission = MakeDriftingMission(3000, 4, 0.01, 0.002);
  mission.Slip(1777, Rigid3d(ExpSO3({0, 0, 0.1}), Eigen::Vector3d(0.5, 0, 0)));
  const auto found = FindDriftOnset(ComparisonOf(mission), SynchronizationOptions(),
                                    {{}, mission.step_covariance, {}});
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->row, 1776);
  EXPECT_EQ(found->keyframe_index, 2 * 1776);
}

TEST(StandingOutBand, IsTheOneFurthestAboveItsOwnFloor) {
  Eigen::MatrixXd discrepancy(5, 3);
  discrepancy << 10, 1, 1, 10, 1, 1, 12, 4, 1, 10, 1, 2, 10, 1, 1;
  EXPECT_EQ(StandingOutBand(discrepancy, 2), Band::kMid);
  EXPECT_EQ(StandingOutBand(discrepancy, 3), Band::kSmall);
}

}  // namespace
}  // namespace overtone
