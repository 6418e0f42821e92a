// SPDX-License-Identifier: Apache-2.0
// Pairwise consistency of n closures between two drifted missions of 300 m, `wrong` per cent of
// them wrong: comparing all (what a changed trajectory costs), the search for the largest set
// alone, and one more closure with the set that follows.
#include <benchmark/benchmark.h>

#include "overtone/core/estimation/pairwise_consistency.h"
#include "overtone/tests/core/estimation/inter_mission_world.h"

namespace overtone {
namespace {

struct Case {
  explicit Case(const benchmark::State& state)
      : random(1), world(/*noise=*/1, random), consistency({}) {
    for (int k = 0; k < state.range(0); ++k) AddOne(k * 37 % 100 < state.range(1));
  }

  void AddOne(bool wrong) {
    const auto status = consistency.Add(
        wrong ? world.WrongClosure(random) : world.RightClosure(random), world.a, world.b);
    if (!status.ok()) std::abort();
  }

  std::mt19937 random;
  InterMissionWorld world;
  PairwiseConsistency consistency;
};

void Report(const Clique& set, benchmark::State& state) {
  state.counters["size"] = set.members.size();
  state.counters["bound"] = set.upper_bound;
  state.counters["branches"] = set.branches;
}

void BM_CompareAll(benchmark::State& state) {
  Case c(state);
  for (auto _ : state) c.consistency.Rebuild(c.world.a, c.world.b);
}

void BM_Search(benchmark::State& state) {
  Case c(state);
  BitGraph graph(c.consistency.Size());
  for (int k = 0; k < graph.NumNodes(); ++k) {
    for (int l = 0; l < k; ++l) {
      if (c.consistency.Agree(k, l)) graph.Connect(k, l);
    }
  }
  for (auto _ : state) Report(MaximumClique(graph, {}, {}), state);
}

// The set grows from n by the number of iterations.
void BM_OneMore(benchmark::State& state) {
  Case c(state);
  c.consistency.ConsistentSet();
  int k = 0;
  for (auto _ : state) {
    c.AddOne(k++ % 2 == 0);
    Report(c.consistency.ConsistentSet(), state);
  }
}

// Not of closures: graphs of equal size whose edges are random, the hard case.
void BM_SearchRandomGraph(benchmark::State& state) {
  std::mt19937 random(1);
  BitGraph graph(state.range(0));
  for (int a = 0; a < graph.NumNodes(); ++a) {
    for (int b = 0; b < a; ++b) {
      if (static_cast<int>(random() % 100) < state.range(1)) graph.Connect(a, b);
    }
  }
  for (auto _ : state) Report(MaximumClique(graph, {}, {}), state);
}

void Closures(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"closures", "wrong"})->Unit(benchmark::kMillisecond);
  for (const int n : {50, 200, 500, 1000, 2000}) {
    for (const int wrong : {0, 50, 80}) benchmark->Args({n, wrong});
  }
}
BENCHMARK(BM_CompareAll)->Apply(Closures);
BENCHMARK(BM_Search)->Apply(Closures);
BENCHMARK(BM_OneMore)->Apply(Closures)->Iterations(20);
BENCHMARK(BM_SearchRandomGraph)
    ->ArgNames({"nodes", "density"})
    ->ArgsProduct({{200, 500, 2000}, {10, 50, 90}})
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace overtone

BENCHMARK_MAIN();
