// SPDX-License-Identifier: Apache-2.0
// The server's cycle: from a robot's last submap to the snapshot that holds it, in a map that is
// large already; what the map and its snapshots take of memory; and plain batch Ceres on the same
// problem from the same poses, after every twelfth cycle (`batch` 0: not, where its memory would
// not do). cost_above_batch: the largest; the others are medians.
//
// An iteration is a cycle; all times in milliseconds, *_cpu_ms those of all threads: on a busy
// machine the only ones that say something. `*_bytes` are for each keyframe.
#include <malloc.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#include "benchmark/benchmark.h"
#include "overtone/core/estimation/pose_graph_optimizer.h"
#include "overtone/tests/support/full_graph.h"
#include "overtone/tests/support/street_team.h"

namespace overtone {
namespace {

using Clock = std::chrono::steady_clock;

constexpr int kCycles = 60;
constexpr int kCyclesPerBatch = 12;

double MsSince(Clock::time_point begin) {
  return std::chrono::duration<double, std::milli>(Clock::now() - begin).count();
}

// Of all threads: on a busy machine the only time that says something.
double CpuMs() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

double HeapBytes() {
  const struct mallinfo2 info = mallinfo2();
  return static_cast<double>(info.uordblks + info.hblkhd);
}

double Quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const auto last = static_cast<double>(values.size() - 1);
  return values[static_cast<size_t>(std::ceil(share * last))];
}

// Grows the map with a revision whenever it has grown by a fifth.
void Grow(StreetTeam& team, MultiRobotMap& map, int64_t keyframes) {
  int64_t next = 0;
  while (team.NumKeyframes() < keyframes) {
    team.AddSubmap(map);
    if (team.NumKeyframes() < next) continue;
    map.Optimise();
    next = team.NumKeyframes() + std::max<int64_t>(200, team.NumKeyframes() / 5);
  }
}

// Plain batch Ceres after a cycle.
struct Batch {
  double ms = 0, cpu_ms = 0;
  double cost_above = 0;  // the cycle's, as a share
};

Batch RunBatch(const MapSnapshot& before, const MapSnapshot& after, int threads) {
  PoseGraphOptimizerOptions options;
  options.function_tolerance = 1e-8;
  options.num_threads = threads;
  const PoseGraph graph = FullGraph(before, after);
  const double cpu_before = CpuMs();
  const Clock::time_point begin = Clock::now();
  const auto result = OptimizePoseGraph(graph, options);
  if (!result.ok()) std::abort();
  return {MsSince(begin), CpuMs() - cpu_before, after.final_cost / result->final_cost - 1};
}

void BM_Cycle(benchmark::State& state) {
  const int robots = static_cast<int>(state.range(0));
  const int64_t keyframes = state.range(1);
  const int threads = static_cast<int>(state.range(2));
  const bool run_batch = state.range(3) != 0;
  MultiRobotMapOptions options;
  options.num_threads = threads;
  MultiRobotMap map(options);
  StreetTeam team(robots, keyframes);
  const double heap_before = HeapBytes();
  const Clock::time_point begin = Clock::now();
  Grow(team, map, keyframes);
  std::shared_ptr<const MapSnapshot> before = map.Optimise(), after = before;
  const double growing_s = MsSince(begin) / 1e3;
  const auto n = static_cast<double>(team.NumKeyframes());
  const double map_bytes = (HeapBytes() - heap_before - team.HeapBytes()) / n;
  std::vector<double> ms, cpu_ms, batch_ms, batch_cpu_ms, costs_above;
  for (auto _ : state) {
    team.Prepare();
    before = after;
    const double cpu_before = CpuMs();
    const Clock::time_point submap = Clock::now();
    team.AddPrepared(map);
    after = map.Optimise();
    ms.push_back(MsSince(submap));
    state.SetIterationTime(ms.back() / 1e3);
    cpu_ms.push_back(CpuMs() - cpu_before);
    if (!run_batch || ms.size() % kCyclesPerBatch != 0) continue;
    const Batch batch = RunBatch(*before, *after, threads);
    batch_ms.push_back(batch.ms);
    batch_cpu_ms.push_back(batch.cpu_ms);
    costs_above.push_back(batch.cost_above);
  }
  // Both hold the same keyframes but for one submap.
  const double heap_mb = HeapBytes() / 1e6;
  before.reset();
  const double snapshot_bytes = (1e6 * heap_mb - HeapBytes()) / n;
  if (run_batch) {
    state.counters["batch_ms"] = Quantile(batch_ms, 0.5);
    state.counters["batch_cpu_ms"] = Quantile(batch_cpu_ms, 0.5);
    state.counters["cost_above_batch"] = Quantile(costs_above, 1);
  }
  state.counters["closures"] = static_cast<double>(after->closures.size());
  state.counters["p50_ms"] = Quantile(ms, 0.5);
  state.counters["p99_ms"] = Quantile(ms, 0.99);
  state.counters["p50_cpu_ms"] = Quantile(cpu_ms, 0.5);
  state.counters["p99_cpu_ms"] = Quantile(cpu_ms, 0.99);
  state.counters["map_bytes"] = map_bytes;
  state.counters["snapshot_bytes"] = snapshot_bytes;
  state.counters["growing_s"] = growing_s;
  state.counters["heap_MB"] = heap_mb;
}
BENCHMARK(BM_Cycle)
    ->ArgNames({"robots", "keyframes", "threads", "batch"})
    ->Args({10, 1000, 1, 1})
    ->Args({10, 10000, 1, 1})
    ->Args({10, 10000, 2, 1})
    ->Args({100, 10000, 1, 1})
    ->Args({10, 100000, 1, 1})
    ->Args({10, 100000, 2, 1})
    ->Args({100, 100000, 1, 1})
    ->Args({10, 1000000, 1, 0})
    ->Args({10, 1000000, 2, 0})
    ->UseManualTime()
    ->Iterations(kCycles)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace overtone

BENCHMARK_MAIN();
