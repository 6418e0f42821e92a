// SPDX-License-Identifier: Apache-2.0
// The server's cycle: from a robot's last submap to the snapshot that holds it, in a map that is
// large already; what the map and its snapshots take of memory; and plain batch Ceres on the same
// problem from the same poses.
//
//   map_cycle_benchmark ROBOTS KEYFRAMES THREADS CYCLES [BATCH_RUNS]
//
// Prints one row of the table in README.md.
#include <malloc.h>
#include <time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "overtone/core/estimation/pose_graph_optimizer.h"
#include "overtone/tests/support/full_graph.h"
#include "overtone/tests/support/street_team.h"

namespace overtone {
namespace {

using Clock = std::chrono::steady_clock;

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

int Run(int robots, int64_t keyframes, int threads, int cycles, int batch_runs) {
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
  std::vector<double> ms, cpu_ms;
  for (int k = 0; k < cycles; ++k) {
    team.Prepare();
    before = after;
    const double cpu_before = CpuMs();
    const Clock::time_point submap = Clock::now();
    team.AddPrepared(map);
    after = map.Optimise();
    ms.push_back(MsSince(submap));
    cpu_ms.push_back(CpuMs() - cpu_before);
  }
  // Both hold the same keyframes but for one submap.
  const double heap_both = HeapBytes();
  const PoseGraph graph = FullGraph(*before, *after);
  const double heap_graph = HeapBytes();
  before.reset();
  const double snapshot_bytes = (heap_graph - HeapBytes()) / n;
  PoseGraphOptimizerOptions batch_options;
  batch_options.function_tolerance = 1e-8;
  batch_options.num_threads = threads;
  double batch_ms = 0, batch_cpu_ms = 0, batch_cost = 0;
  for (int k = 0; k < batch_runs; ++k) {
    const double cpu_before = CpuMs();
    const Clock::time_point batch = Clock::now();
    const auto result = OptimizePoseGraph(graph, batch_options);
    const double run_ms = MsSince(batch);
    if (!result.ok()) return 1;
    const double run_cpu_ms = CpuMs() - cpu_before;
    batch_ms = k == 0 ? run_ms : std::min(batch_ms, run_ms);
    batch_cpu_ms = k == 0 ? run_cpu_ms : std::min(batch_cpu_ms, run_cpu_ms);
    batch_cost = result->final_cost;
  }
  int64_t in_use = 0;
  for (const ClosureRecord& record : after->closures) in_use += InUse(record.verdict);
  std::printf(
      "| %d | %.0f | %d | %zu (%ld) | %.1f / %.1f | %.1f / %.1f | %.1f | %.1f | %.2e | "
      "%.0f | %.0f | %.1f | %.0f |\n",
      robots, n, threads, after->closures.size(), static_cast<long>(in_use), Quantile(ms, 0.5),
      Quantile(ms, 0.99), Quantile(cpu_ms, 0.5), Quantile(cpu_ms, 0.99), batch_ms, batch_cpu_ms,
      batch_runs > 0 ? after->final_cost / batch_cost - 1 : 0, map_bytes, snapshot_bytes, growing_s,
      heap_both / 1e6);
  return 0;
}

}  // namespace
}  // namespace overtone

int main(int argc, char** argv) {
  if (argc < 5) {
    std::printf("usage: map_cycle_benchmark ROBOTS KEYFRAMES THREADS CYCLES [BATCH_RUNS]\n");
    return 2;
  }
  std::printf(
      "| robots | keyframes | threads | closures (in use) | p50 / p99 ms | CPU p50 / p99 ms | "
      "batch ms | batch CPU ms | cost above batch | map B/keyframe | next snapshot B/keyframe | "
      "growing s | heap MB |\n");
  return overtone::Run(std::atoi(argv[1]), std::atoll(argv[2]), std::atoi(argv[3]),
                       std::atoi(argv[4]), argc > 5 ? std::atoi(argv[5]) : 1);
}
