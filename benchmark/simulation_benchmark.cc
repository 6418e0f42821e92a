// SPDX-License-Identifier: Apache-2.0
// Time of a simulated team: building a world with its drives, and casting the rays of scans from
// every tenth keyframe of the scripted team. Arguments: position of the scene in SceneNames();
// rings.
#include <string>

#include "benchmark/benchmark.h"
#include "overtone/core/simulation/scenario.h"

namespace overtone {
namespace {

Scenario Simulate(benchmark::State& state) {
  ScenarioOptions options;
  options.scene = SceneNames()[state.range(0)];
  state.SetLabel(options.scene);
  return *SimulateScenario(options);
}

void BM_BuildWorldAndDrive(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(Simulate(state));
}

// With range noise: what writing a scan costs but for the disk.
void BM_Scan(benchmark::State& state) {
  const Scenario scenario = Simulate(state);
  LidarOptions options;
  options.rings = static_cast<int>(state.range(1));
  const Lidar lidar = *Lidar::Create(options);
  int64_t scans = 0;
  for (auto _ : state) {
    for (const ScenarioRobot& robot : scenario.robots) {
      const int num_keyframes = static_cast<int>(robot.ground_truth.size());
      for (int k = 0; k < num_keyframes; k += 10, ++scans) {
        benchmark::DoNotOptimize(robot.Scan(scenario.world, lidar, k));
      }
    }
  }
  state.SetItemsProcessed(scans * lidar.num_rays());
}

BENCHMARK(BM_BuildWorldAndDrive)->ArgName("scene")->DenseRange(0, 3)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Scan)
    ->ArgNames({"scene", "rings"})
    ->ArgsProduct({{0, 1, 2, 3}, {16, 64}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace overtone

BENCHMARK_MAIN();
