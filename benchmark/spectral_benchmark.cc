// SPDX-License-Identifier: Apache-2.0
// Growth with the number of nodes N on a team's radius graph (five robots, 7 m, mean degree about
// 120). The complexity rows give the fitted growth; `exponent` of log time over log N follows from
// any two rows.
#include <benchmark/benchmark.h>

#include "overtone/core/spectral/chebyshev_filter.h"
#include "overtone/core/spectral/kron_reduction.h"
#include "overtone/core/spectral/krylov_filter.h"
#include "overtone/core/spectral/lanczos.h"
#include "overtone/core/spectral/reduction_node_selection.h"
#include "overtone/core/spectral/wavelet_transform.h"
#include "overtone/tests/support/synthetic_graph.h"

namespace overtone {
namespace {

// Rebuilt only when N changes: benchmarks of one N would otherwise spend their time here.
const SyntheticTeam& Team(int num_nodes) {
  static SyntheticTeam team;
  if (static_cast<int>(team.server.size()) != num_nodes) team = MakeSyntheticTeam(num_nodes);
  return team;
}

std::vector<int> KeepSixty(int num_nodes) {
  std::vector<int> kept;
  for (int i = 0; i < num_nodes; ++i) {
    if (i % 5 < 3) kept.push_back(i);
  }
  return kept;
}

// Edges of the reduced graph over edges of the given one.
double EdgeRatio(const SparseMatrix& reduced, const SparseMatrix& laplacian) {
  return static_cast<double>(reduced.nonZeros() - reduced.rows()) /
         (laplacian.nonZeros() - laplacian.rows());
}

void BM_RadiusGraph(benchmark::State& state) {
  const SyntheticTeam& team = Team(state.range(0));
  for (auto _ : state)
    benchmark::DoNotOptimize(RadiusGraphAdjacency(team.server, RadiusGraphOptions()));
  state.SetComplexityN(state.range(0));
}

void BM_LargestEigenvalue(benchmark::State& state) {
  const SparseMatrix laplacian = Team(state.range(0)).Laplacian();
  for (auto _ : state) benchmark::DoNotOptimize(LargestEigenvalue(laplacian));
  state.SetComplexityN(state.range(0));
}

void BM_ExactFilter(benchmark::State& state) {
  const SyntheticTeam& team = Team(state.range(0));
  const SparseMatrix laplacian = team.Laplacian();
  WaveletOptions options;
  options.method = FilterMethod::kExact;
  for (auto _ : state) {
    benchmark::DoNotOptimize(WaveletCoefficients(laplacian, team.DifferenceSignal(), options));
  }
  state.SetComplexityN(state.range(0));
}

void BM_KrylovFilter(benchmark::State& state) {
  const SyntheticTeam& team = Team(state.range(0));
  const SparseMatrix laplacian = team.Laplacian();
  const Eigen::VectorXd signal = team.DifferenceSignal();
  for (auto _ : state) {
    const auto result = KrylovFilter(laplacian, signal, 6, 1e-4, 600);
    state.counters["dimension"] = result.ok() ? result->order : 0;
  }
  state.SetComplexityN(state.range(0));
}

void BM_ChebyshevFilter(benchmark::State& state) {
  const SyntheticTeam& team = Team(state.range(0));
  const SparseMatrix laplacian = team.Laplacian();
  const Eigen::VectorXd signal = team.DifferenceSignal();
  for (auto _ : state) {
    const auto result = ChebyshevFilter(laplacian, signal, 6, 1e-4);
    state.counters["order"] = result.ok() ? result->order : 0;
  }
  state.SetComplexityN(state.range(0));
}

void BM_KronExact(benchmark::State& state) {
  const SparseMatrix laplacian = Team(state.range(0)).Laplacian();
  for (auto _ : state) {
    const auto result = KronReduction(laplacian, KeepSixty(state.range(0)));
    state.counters["edge_ratio"] = result.ok() ? EdgeRatio(result->laplacian, laplacian) : 0;
  }
  state.SetComplexityN(state.range(0));
}

void BM_KronSparsified(benchmark::State& state) {
  const SparseMatrix laplacian = Team(state.range(0)).Laplacian();
  for (auto _ : state) {
    const auto result = SparsifiedKronReduction(laplacian, KeepSixty(state.range(0)), 1e-3);
    state.counters["edge_ratio"] = result.ok() ? EdgeRatio(result->laplacian, laplacian) : 0;
    state.counters["dropped"] = result.ok() ? result->dropped_weight_fraction : 0;
  }
  state.SetComplexityN(state.range(0));
}

void BM_SelectNodes(benchmark::State& state) {
  const SparseMatrix laplacian = Team(state.range(0)).Laplacian();
  for (auto _ : state)
    benchmark::DoNotOptimize(SelectNodes(laplacian, 0.6 * state.range(0), {}, {}));
  state.SetComplexityN(state.range(0));
}

// What the graph monitor does above its node limit: choose, then reduce.
void BM_Reduction(benchmark::State& state) {
  const SparseMatrix laplacian = Team(state.range(0)).Laplacian();
  const int keep = static_cast<int>(0.6 * static_cast<double>(state.range(0)));
  for (auto _ : state) {
    const auto kept = SelectNodes(laplacian, keep, {}, {});
    if (!kept.ok()) return state.SkipWithError(kept.status().ToString().c_str());
    const auto result = SparsifiedKronReduction(laplacian, *kept, 1e-3);
    state.counters["edge_ratio"] = result.ok() ? EdgeRatio(result->laplacian, laplacian) : 0;
    state.counters["dropped"] = result.ok() ? result->dropped_weight_fraction : 0;
  }
  state.SetComplexityN(state.range(0));
}

void Sizes(benchmark::internal::Benchmark* benchmark) {
  for (const int n : {200, 1000, 5000, 10000, 20000}) benchmark->Arg(n);
  benchmark->Unit(benchmark::kMillisecond)->Complexity(benchmark::oAuto);
}
BENCHMARK(BM_RadiusGraph)->Apply(Sizes);
BENCHMARK(BM_LargestEigenvalue)->Apply(Sizes);
BENCHMARK(BM_ExactFilter)
    ->Arg(100)
    ->Arg(200)
    ->Arg(500)
    ->Arg(1000)
    ->Unit(benchmark::kMillisecond)
    ->Complexity();
BENCHMARK(BM_KrylovFilter)->Apply(Sizes);
BENCHMARK(BM_ChebyshevFilter)->Apply(Sizes);
BENCHMARK(BM_KronExact)
    ->Arg(200)
    ->Arg(1000)
    ->Arg(5000)
    ->Arg(10000)
    ->Unit(benchmark::kMillisecond)
    ->Complexity();
BENCHMARK(BM_KronSparsified)->Apply(Sizes);
BENCHMARK(BM_SelectNodes)->Apply(Sizes)->Arg(100000);
BENCHMARK(BM_Reduction)->Apply(Sizes)->Arg(100000);

}  // namespace
}  // namespace overtone

BENCHMARK_MAIN();
