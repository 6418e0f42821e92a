// SPDX-License-Identifier: Apache-2.0
// Milliseconds to register one cloud on another, one thread. Two clouds are given, or a simulated
// pair is taken:
//
//   registration_benchmark [source.ply target.ply]
#include <benchmark/benchmark.h>

#include <cstdio>

#include "overtone/core/graph/point_cloud_io.h"
#include "overtone/core/registration/coarse_to_fine.h"
#include "overtone/core/registration/gicp.h"
#include "overtone/tests/support/simulated_scans.h"

namespace overtone {
namespace {

ScanPair pair;

std::shared_ptr<const RegistrationCloud> Prepare(const PointCloud& cloud, double voxel_size_m) {
  RegistrationCloudOptions options;
  options.voxel_size_m = voxel_size_m;
  return *RegistrationCloud::Create(cloud.points, options);
}

double VoxelSize(const benchmark::State& state) { return state.range(0) / 100.0; }

// Both clouds, as every pair of new clouds needs it.
void BM_Preprocessing(benchmark::State& state) {
  for (auto _ : state) {
    const auto source = Prepare(pair.source, VoxelSize(state));
    const auto target = Prepare(pair.target, VoxelSize(state));
    state.counters["points"] = source->size();
    benchmark::DoNotOptimize(target->size());
  }
}

void BM_Gicp(benchmark::State& state) {
  const auto source = Prepare(pair.source, VoxelSize(state));
  const auto target = Prepare(pair.target, VoxelSize(state));
  for (auto _ : state) {
    const GicpEstimate estimate = Gicp(*source, *target, Rigid3d(), GicpOptions());
    state.counters["iterations"] = estimate.iterations;
  }
}

void BM_Pyramids(benchmark::State& state) {
  for (auto _ : state) {
    benchmark::DoNotOptimize(RegistrationPyramid::Create(pair.source, {}));
    benchmark::DoNotOptimize(RegistrationPyramid::Create(pair.target, {}));
  }
}

void BM_CoarseToFine(benchmark::State& state) {
  const CoarseToFineOptions options;
  const auto source = RegistrationPyramid::Create(pair.source, options);
  const auto target = RegistrationPyramid::Create(pair.target, options);
  for (auto _ : state) {
    const auto result = RegisterCoarseToFine(*source, *target, Rigid3d(), options);
    state.counters["iterations"] = result->iterations;
  }
}

BENCHMARK(BM_Preprocessing)->Arg(25)->Arg(50)->ArgName("voxel_cm")->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Gicp)->Arg(25)->Arg(50)->ArgName("voxel_cm")->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Pyramids)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_CoarseToFine)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace overtone

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  auto& pair = overtone::pair;
  if (argc == 3) {
    const auto source = overtone::ReadPointCloud(argv[1]);
    const auto target = overtone::ReadPointCloud(argv[2]);
    for (const auto& status : {source.status(), target.status()}) {
      if (status.ok()) continue;
      std::fprintf(stderr, "%s\n", status.ToString().c_str());
      return 1;
    }
    pair.source = *source;
    pair.target = *target;
  } else {
    pair = overtone::ScanTwice(overtone::HallWorld(), overtone::StandingAt(0.5, 0, 0.03),
                               overtone::StandingAt(0, 0, 0), {64, 1024}, /*seed=*/1);
  }
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
