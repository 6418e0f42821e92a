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

MapGraph Graph(const std::vector<Rigid3d>& server) {
  MapGraph graph;
  graph.missions.resize(1);
  graph.missions[0].id = kMission;
  for (int i = 0; i < server.size(); ++i) {
    graph.missions[0].nodes.push_back({i, {i}, server[i], i % 20 == 0, false});
  }
  return graph;
}

std::vector<NodePose> Drifted(const std::vector<Rigid3d>& server) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal(0, 1);
  std::vector<NodePose> onboard;
  Rigid3d pose = server.front();
  for (int i = 0; i < server.size(); ++i) {
    if (i > 0) {
      Vector6d noise;
      for (int k = 0; k < 6; ++k) noise[k] = (k < 3 ? 0.01 : 0.001) * normal(random);
      pose = pose * (server[i - 1].Inverse() * server[i]) * Exp(noise);
    }
    onboard.push_back({i, {i}, pose});
  }
  return onboard;
}

// Every node anew by a few millimetres, as an optimiser's next revision has them.
std::vector<Rigid3d> NextRevision(std::vector<Rigid3d> server) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-0.005, 0.005);
  for (Rigid3d& pose : server) {
    pose.translation += Eigen::Vector3d(uniform(random), uniform(random), uniform(random));
  }
  return server;
}

SynchronizationOptions Options(bool se3_log) {
  SynchronizationOptions options;
  options.signal = se3_log ? SignalKind::kSe3Log : SignalKind::kDistance;
  return options;
}

// From a graph to constraints in force. Returns their number; -1: refused.
int Synchronize(TrajectoryComparator& comparator, ConstraintHistory& history, const MapGraph& graph,
                const std::vector<NodePose>& onboard, const SynchronizationOptions& options) {
  const auto comparison = comparator.Compare(graph, kMission, onboard);
  if (!comparison.ok()) return -1;
  history.Commit(
      history.Reconcile(SelectConstraints(*comparison, options, {{}, {}, history.Active()}),
                        *comparison, options.constraints, Unproposed::kRetract));
  return static_cast<int>(history.Active().size());
}

void BM_CompareTrajectories(benchmark::State& state) {
  const std::vector<Rigid3d> server = Sweep(static_cast<int>(state.range(0)));
  const MapGraph graph = Graph(server);
  const std::vector<NodePose> onboard = Drifted(server);
  const SynchronizationOptions options = Options(state.range(1) == 1);
  int num_constraints = 0;
  for (auto _ : state) {
    TrajectoryComparator comparator(options);
    ConstraintHistory history;
    num_constraints = Synchronize(comparator, history, graph, onboard, options);
    if (num_constraints < 0) state.SkipWithError("refused");
  }
  state.counters["constraints"] = num_constraints;
}
// One comparator, revision after revision, each of which moves every node by a few millimetres.
void BM_CompareNextRevision(benchmark::State& state) {
  const std::vector<Rigid3d> server = Sweep(static_cast<int>(state.range(0)));
  const MapGraph graphs[] = {Graph(server), Graph(NextRevision(server))};
  const std::vector<NodePose> onboard = Drifted(server);
  const SynchronizationOptions options = Options(state.range(1) == 1);
  TrajectoryComparator comparator(options);
  ConstraintHistory history;
  (void)Synchronize(comparator, history, graphs[0], onboard, options);
  int revision = 0, num_reused = 0;
  for (auto _ : state) {
    if (Synchronize(comparator, history, graphs[++revision % 2], onboard, options) < 0) {
      state.SkipWithError("refused");
    }
    num_reused += comparator.filter().reused_coefficients();
  }
  state.counters["reused"] = static_cast<double>(num_reused) / revision;
}
// Selection alone: with nothing in force, and of a revision that moves every node by a few
// millimetres with the knots of the one before in force.
void BM_SelectKnots(benchmark::State& state) {
  const std::vector<Rigid3d> server = Sweep(static_cast<int>(state.range(0)));
  const std::vector<NodePose> onboard = Drifted(server);
  SynchronizationOptions options = Options(false);
  if (state.range(2) == 1) options.selection.tolerance_m = 0.3;
  const auto first = CompareTrajectories(Graph(server), kMission, onboard, options);
  const auto next = CompareTrajectories(Graph(NextRevision(server)), kMission, onboard, options);
  if (!first.ok() || !next.ok()) return state.SkipWithError("refused");
  SelectionContext context;
  if (state.range(1) == 1) context.active = SelectConstraints(*first, options);
  size_t num_constraints = 0;
  for (auto _ : state) num_constraints = SelectConstraints(*next, options, context).size();
  state.counters["constraints"] = static_cast<double>(num_constraints);
}
BENCHMARK(BM_SelectKnots)
    ->ArgNames({"nodes", "in_force", "lenient"})
    ->ArgsProduct({{330, 1000, 2500, 10000}, {0, 1}, {0, 1}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(BM_CompareTrajectories)
    ->ArgNames({"nodes", "se3_log"})
    ->ArgsProduct({{200, 330, 1000, 2500, 5000, 10000, 20000}, {0}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(BM_CompareTrajectories)
    ->ArgNames({"nodes", "se3_log"})
    ->ArgsProduct({{1000, 10000}, {1}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(BM_CompareNextRevision)
    ->ArgNames({"nodes", "se3_log"})
    ->ArgsProduct({{330, 1000, 2500, 5000, 10000, 20000}, {0}})
    ->Unit(benchmark::kMillisecond);
BENCHMARK(BM_CompareNextRevision)
    ->ArgNames({"nodes", "se3_log"})
    ->ArgsProduct({{1000, 10000}, {1}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace overtone

BENCHMARK_MAIN();
