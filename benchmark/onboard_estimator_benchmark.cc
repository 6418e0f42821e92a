// SPDX-License-Identifier: Apache-2.0
// 15 constraints in one batch into the onboard estimator's chain of N poses, and one odometry step
// with its history; figures to hold: 3 / 15 / 60 ms at N = 1,000 / 5,000 / 20,000. And what
// constraints cost the chain's locality: numbers in the Cholesky factor and time, by how they lie.
#include <memory>
#include <random>

#include "benchmark/benchmark.h"
#include "overtone/client/estimator/onboard_estimator.h"

namespace overtone {
namespace {

struct Run {
  std::vector<Rigid3d> truth;
  std::vector<Rigid3d> odometry;
};

// A metre a step in wide curves; 1 cm and 0.02 degrees of noise a step.
Run DriftingRun(int num_poses) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal(0, 1);
  Run run{{Rigid3d()}, {Rigid3d()}};
  for (int i = 1; i < num_poses; ++i) {
    Vector6d motion = Vector6d::Zero(), noise;
    motion[0] = 1;
    motion[5] = 0.05 * std::sin(0.01 * i);
    for (int k = 0; k < 6; ++k) noise[k] = (k < 3 ? 0.01 : 0.00035) * normal(random);
    run.truth.push_back(run.truth.back() * Exp(motion));
    run.odometry.push_back(Exp(motion) * Exp(noise));
  }
  return run;
}

Matrix6d Covariance() {
  Vector6d variance;
  variance << Eigen::Vector3d::Constant(1e-4), Eigen::Vector3d::Constant(1.2e-7);
  return variance.asDiagonal();
}

std::unique_ptr<OnboardEstimator> Estimator(const Run& run) {
  auto estimator = std::make_unique<OnboardEstimator>();
  for (int i = 0; i < run.odometry.size(); ++i) {
    (void)estimator->AddKeyframe(i, {i}, run.odometry[i], Covariance());
  }
  return estimator;
}

// As the server would know it.
void AddChord(const Run& run, int64_t from, int64_t to, ConstraintBatch& batch) {
  Constraint constraint;
  constraint.from = from;
  constraint.to = to;
  constraint.id = std::to_string(from) + "-" + std::to_string(to);
  constraint.from_tform_to = run.truth[from].Inverse() * run.truth[to];
  constraint.covariance = 0.25 * Covariance();
  batch.add.push_back(constraint);
}

// `count` chords over `hops` keyframes, evenly along the run.
ConstraintBatch Chords(const Run& run, int count, int hops) {
  ConstraintBatch batch;
  const int64_t room = static_cast<int64_t>(run.truth.size()) - hops - 1;
  for (int k = 0; k < count; ++k) {
    const int64_t from = k * room / count;
    AddChord(run, from, from + hops, batch);
  }
  return batch;
}

enum Strategy { kLocal, kChained, kTopN, kRandom };

// `count` constraint edges:
// kLocal: over ten keyframes each.  kChained: equal chords, each from where the last ends, as
// `uniform` and `knots` choose them.  kTopN: half of them over one or two keyframes, half from
// those nodes to submaps elsewhere, as the paper's rule chooses them.  kRandom: between any two.
ConstraintBatch Constraints(const Run& run, Strategy strategy, int count) {
  const int64_t last = static_cast<int64_t>(run.truth.size()) - 1;
  if (strategy == kLocal) return Chords(run, count, 10);
  std::mt19937 random(3);
  const auto any_node = [&] { return static_cast<int64_t>(random() % (last - 2)); };
  const auto any_pivot = [&] { return static_cast<int64_t>(random() % (last / 20)) * 20 + 10; };
  ConstraintBatch batch;
  while (batch.add.size() < count) {
    const int64_t k = static_cast<int64_t>(batch.add.size());
    if (strategy == kChained) {
      AddChord(run, k * last / count, (k + 1) * last / count, batch);
      continue;
    }
    const int64_t node = any_node(), other = strategy == kTopN ? any_pivot() : any_node();
    if (node == other) continue;
    AddChord(run, node, other, batch);
    if (strategy == kTopN && k + 1 < count) AddChord(run, node, node + 1 + k % 2, batch);
  }
  return batch;
}

// range(1): constraints applied before, as after a long mission.
void BM_ApplyFifteenConstraints(benchmark::State& state) {
  const int num_poses = static_cast<int>(state.range(0));
  const Run run = DriftingRun(num_poses);
  const ConstraintBatch before = Chords(run, static_cast<int>(state.range(1)), 10);
  const ConstraintBatch batch = Chords(run, 15, num_poses / 16);
  for (auto _ : state) {
    state.PauseTiming();
    auto estimator = Estimator(run);
    absl::Status status = estimator->ApplyConstraints(before);
    state.ResumeTiming();
    status.Update(estimator->ApplyConstraints(batch));
    state.PauseTiming();
    if (!status.ok()) state.SkipWithError(status.ToString().c_str());
    estimator.reset();
    state.ResumeTiming();
  }
}
BENCHMARK(BM_ApplyFifteenConstraints)
    ->ArgNames({"poses", "constraints_before"})
    ->ArgsProduct({{1000, 5000, 20000, 30000}, {0, 300}})
    ->Unit(benchmark::kMillisecond);

void BM_AddKeyframeAfterABatch(benchmark::State& state) {
  const int num_poses = static_cast<int>(state.range(0));
  const Run run = DriftingRun(num_poses);
  auto estimator = Estimator(run);
  (void)estimator->ApplyConstraints(Chords(run, 15, num_poses / 16));
  int64_t next = num_poses;
  for (auto _ : state) {
    (void)estimator->AddKeyframe(next, {next}, run.odometry[1], Covariance());
    ++next;
  }
}
BENCHMARK(BM_AddKeyframeAfterABatch)->Arg(1000)->Arg(20000)->Iterations(10000);

// All constraints at once. non_zeros: of the factor; fill: over those of the chain alone.
void BM_Locality(benchmark::State& state, Strategy strategy) {
  const Run run = DriftingRun(static_cast<int>(state.range(0)));
  const ConstraintBatch batch = Constraints(run, strategy, static_cast<int>(state.range(1)));
  auto chain = Estimator(run);
  (void)chain->ApplyConstraints(ConstraintBatch());
  int64_t non_zeros = 0;
  for (auto _ : state) {
    state.PauseTiming();
    auto estimator = Estimator(run);
    state.ResumeTiming();
    const absl::Status status = estimator->ApplyConstraints(batch);
    state.PauseTiming();
    if (!status.ok()) state.SkipWithError(status.ToString().c_str());
    non_zeros = estimator->FactorNonZeros();
    estimator.reset();
    state.ResumeTiming();
  }
  state.counters["non_zeros"] = static_cast<double>(non_zeros);
  state.counters["fill"] = static_cast<double>(non_zeros) / chain->FactorNonZeros();
}
void LocalitySizes(benchmark::internal::Benchmark* benchmark) {
  benchmark->ArgNames({"poses", "constraints"})->Unit(benchmark::kMillisecond);
  for (const int constraints : {1, 15, 50, 150, 500, 1000}) benchmark->Args({20000, constraints});
}
BENCHMARK_CAPTURE(BM_Locality, local, kLocal)->Apply(LocalitySizes);
BENCHMARK_CAPTURE(BM_Locality, chained, kChained)->Apply(LocalitySizes);
BENCHMARK_CAPTURE(BM_Locality, top_n, kTopN)->Apply(LocalitySizes);
BENCHMARK_CAPTURE(BM_Locality, random, kRandom)->Apply(LocalitySizes);

}  // namespace
}  // namespace overtone

BENCHMARK_MAIN();
