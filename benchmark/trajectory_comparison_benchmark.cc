// SPDX-License-Identifier: Apache-2.0
// One comparison on the robot, end to end: a new revision arrives; graph, filter, selection,
// history. Figures to hold: 15 ms at N = 1,000, 250 ms at 10,000, one core.
#include <cmath>
#include <random>

#include "benchmark/benchmark.h"
#include "overtone/core/synchronization/constraint_history.h"
#include "overtone/core/synchronization/constraint_selection.h"
#include "overtone/core/synchronization/wavelet_discrepancy.h"

namespace overtone {
namespace {

const MissionId kMission = {"robot", "mission"};

// A robot that sweeps a hall to and fro in lanes 3 m apart, a keyframe every 0.8 m: about 60
// neighbours within 7 m.
std::vector<Rigid3d> Sweep(int num_nodes) {
  constexpr double kStep = 0.8, kLane = 3;
  const int per_lane = std::max(10, static_cast<int>(std::sqrt(num_nodes * kLane / kStep)));
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 0.05);
  std::vector<Rigid3d> poses;
  for (int i = 0; i < num_nodes; ++i) {
    const int lane = i / per_lane, along = i % per_lane;
    const bool back = lane % 2 == 1;
    const double x = kStep * (back ? per_lane - 1 - along : along);
    poses.emplace_back(ExpSO3({normal(random), normal(random), (back ? M_PI : 0) + normal(random)}),
                       Eigen::Vector3d(x, kLane * lane, normal(random)));
  }
  return poses;
}

void BM_CompareTrajectories(benchmark::State& state) {
  const int num_nodes = static_cast<int>(state.range(0));
  const std::vector<Rigid3d> server = Sweep(num_nodes);
  std::mt19937 random(2);
  std::normal_distribution<double> normal(0, 1);
  MapGraph graph;
  graph.missions.resize(1);
  graph.missions[0].id = kMission;
  std::vector<NodePose> onboard;
  Rigid3d pose = server.front();
  for (int i = 0; i < num_nodes; ++i) {
    graph.missions[0].nodes.push_back({i, {i}, server[i], i % 20 == 0, false});
    if (i > 0) {
      Vector6d noise;
      for (int k = 0; k < 6; ++k) noise[k] = (k < 3 ? 0.01 : 0.001) * normal(random);
      pose = pose * (server[i - 1].Inverse() * server[i]) * Exp(noise);
    }
    onboard.push_back({i, {i}, pose});
  }
  SynchronizationOptions options;
  options.signal = state.range(1) == 0 ? SignalKind::kDistance : SignalKind::kSe3Log;
  int num_constraints = 0;
  for (auto _ : state) {
    const auto comparison = CompareTrajectories(graph, kMission, onboard, options);
    if (!comparison.ok()) {
      state.SkipWithError(comparison.status().ToString().c_str());
      break;
    }
    const ConstraintBatch batch = ConstraintHistory().Reconcile(
        SelectConstraints(*comparison, options), *comparison, options.constraints);
    num_constraints = static_cast<int>(batch.add.size());
  }
  state.counters["constraints"] = num_constraints;
}
BENCHMARK(BM_CompareTrajectories)
    ->ArgNames({"nodes", "se3_log"})
    ->ArgsProduct({{200, 1000, 5000, 10000, 20000}, {0}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(BM_CompareTrajectories)
    ->ArgNames({"nodes", "se3_log"})
    ->ArgsProduct({{1000, 10000}, {1}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace overtone

BENCHMARK_MAIN();
