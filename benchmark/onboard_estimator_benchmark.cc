// SPDX-License-Identifier: Apache-2.0
// 15 constraints in one batch into the onboard estimator's chain of N poses; and one odometry step
// with its history. Figures to hold: 3 / 15 / 60 ms at N = 1,000 / 5,000 / 20,000.
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

// `count` chords over `hops` keyframes, evenly along the run, as the server would know them.
ConstraintBatch Chords(const Run& run, int count, int hops, const std::string& prefix) {
  ConstraintBatch batch;
  const int num_poses = static_cast<int>(run.truth.size());
  for (int k = 0; k < count; ++k) {
    Constraint constraint;
    constraint.from = static_cast<int64_t>(k) * (num_poses - hops - 1) / count;
    constraint.to = constraint.from + hops;
    constraint.id = prefix + std::to_string(k);
    constraint.from_tform_to = run.truth[constraint.from].Inverse() * run.truth[constraint.to];
    constraint.covariance = 0.25 * Covariance();
    batch.add.push_back(constraint);
  }
  return batch;
}

// range(1): constraints applied before, as after a long mission.
void BM_ApplyFifteenConstraints(benchmark::State& state) {
  const int num_poses = static_cast<int>(state.range(0));
  const Run run = DriftingRun(num_poses);
  const ConstraintBatch before = Chords(run, static_cast<int>(state.range(1)), 10, "before");
  const ConstraintBatch batch = Chords(run, 15, num_poses / 16, "batch");
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
  (void)estimator->ApplyConstraints(Chords(run, 15, num_poses / 16, "batch"));
  int64_t next = num_poses;
  for (auto _ : state) {
    (void)estimator->AddKeyframe(next, {next}, run.odometry[1], Covariance());
    ++next;
  }
}
BENCHMARK(BM_AddKeyframeAfterABatch)->Arg(20000)->Iterations(10000);

}  // namespace
}  // namespace overtone

BENCHMARK_MAIN();
