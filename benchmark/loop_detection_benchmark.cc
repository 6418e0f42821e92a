// SPDX-License-Identifier: Apache-2.0
// What a cloud costs on its way to a loop closure, stage by stage, one thread: items per second are
// clouds, or candidates for the last two. One robot's places, and the same way driven again, 0.2 m
// aside.
#include <memory>
#include <vector>

#include "benchmark/benchmark.h"
#include "overtone/benchmark/simulated_places.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/core/mapping/cloud_verifier.h"
#include "overtone/core/mapping/loop_closure.h"
#include "overtone/core/place_recognition/scan_context_proposer.h"

namespace overtone {
namespace {

constexpr int kPlaces = 100;

struct Drives {
  std::vector<SimulatedPlace> first = SimulatePlaces(kPlaces, 0, 1);
  std::vector<SimulatedPlace> again = SimulatePlaces(kPlaces, 0.2, 2);

  const SimulatedPlace& At(const NodeId& node) const {
    return (node.mission.robot == "first" ? first : again)[node.index];
  }
  PlaceView View(const NodeId& node) const {
    const SimulatedPlace& place = At(node);
    return {node, 1.5 * node.index, place.world_from_body.rotation, place.cloud};
  }
};

const Drives& TheDrives() {
  static const Drives drives;
  return drives;
}

NodeId First(int i) { return {{"first", "m0"}, i}; }
NodeId Again(int i) { return {{"again", "m0"}, i}; }

// Shown the first drive.
std::unique_ptr<ScanContextProposer> FilledProposer() {
  auto proposer = std::make_unique<ScanContextProposer>(ScanContextProposerOptions());
  for (int i = 0; i < kPlaces; ++i) proposer->Propose(TheDrives().View(First(i)));
  return proposer;
}

std::vector<LoopCandidate> Candidates() {
  const auto proposer = FilledProposer();
  std::vector<LoopCandidate> all;
  for (int i = 0; i < kPlaces; ++i) {
    const auto proposed = proposer->Propose(TheDrives().View(Again(i)));
    all.insert(all.end(), proposed.begin(), proposed.end());
  }
  return all;
}

void BM_Encode(benchmark::State& state) {
  const Drives& drives = TheDrives();
  int64_t clouds = 0;
  double points = 0, bytes = 0;
  for (auto _ : state) {
    const SimulatedPlace& place = drives.first[clouds++ % kPlaces];
    benchmark::DoNotOptimize(EncodePointCloud(*place.cloud, {}));
    points += place.cloud->points.size();
    bytes += place.blob->size();
  }
  state.SetItemsProcessed(clouds);
  state.counters["points"] = points / clouds;
  state.counters["bytes"] = bytes / clouds;
}

void BM_Decode(benchmark::State& state) {
  int64_t clouds = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(DecodePointCloud(*TheDrives().first[clouds++ % kPlaces].blob));
  }
  state.SetItemsProcessed(clouds);
}

void BM_Describe(benchmark::State& state) {
  int64_t clouds = 0;
  for (auto _ : state) {
    const SimulatedPlace& place = TheDrives().first[clouds++ % kPlaces];
    benchmark::DoNotOptimize(
        ComputeScanContext(*place.cloud, LevelFromBody(place.world_from_body.rotation), {}));
  }
  state.SetItemsProcessed(clouds);
}

// Describe, search among the places so far, keep: from 100 of them to 200.
void BM_Propose(benchmark::State& state) {
  int64_t clouds = 0, proposed = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const auto proposer = FilledProposer();
    state.ResumeTiming();
    for (int i = 0; i < kPlaces; ++i, ++clouds) {
      proposed += proposer->Propose(TheDrives().View(Again(i))).size();
    }
  }
  state.SetItemsProcessed(clouds);
  state.counters["candidates"] = static_cast<double>(proposed) / clouds;
  state.counters["candidates/s"] =
      benchmark::Counter(static_cast<double>(proposed), benchmark::Counter::kIsRate);
}

void BM_Pyramid(benchmark::State& state) {
  int64_t clouds = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        RegistrationPyramid::Create(*TheDrives().first[clouds++ % kPlaces].cloud, {}));
  }
  state.SetItemsProcessed(clouds);
}

// Off by more than 0.3 m or 3 degrees.
bool IsWrong(const LoopCandidate& candidate) {
  const Rigid3d truth = TheDrives().At(candidate.from).world_from_body.Inverse() *
                        TheDrives().At(candidate.to).world_from_body;
  const Rigid3d error = truth.Inverse() * candidate.from_tform_to;
  return error.translation.norm() > 0.3 || LogSO3(error.rotation).norm() > 0.052;
}

// Every candidate measured. Of them, shares: whose figures are in order, `ties` that may tie
// missions and `weak` ones with an open direction; of these two, how many are wrong. What checks
// closures against each other comes later and is not in here. Argument: pyramids of all views are
// kept (1) or of none (0).
void BM_Verify(benchmark::State& state) {
  const std::vector<LoopCandidate> candidates = Candidates();
  const bool kept = state.range(0) != 0;
  const CloudVerifier verifier({}, kept ? 2 * kPlaces : 1);
  double verified = 0, ties = 0, weak = 0, wrong_ties = 0, wrong_weak = 0;
  const auto verify_all = [&] {
    verified = ties = weak = wrong_ties = wrong_weak = 0;
    for (LoopCandidate candidate : candidates) {
      ++verified;
      const PlaceView from = TheDrives().View(candidate.from), to = TheDrives().View(candidate.to);
      if (!verifier.Verify(from, to, candidate).ok()) continue;
      if (JudgeFigures(candidate) != ClosureVerdict::kPending) continue;
      ++(IsWeak(candidate) ? weak : ties);
      (IsWeak(candidate) ? wrong_weak : wrong_ties) += IsWrong(candidate);
    }
  };
  if (kept) verify_all();
  for (auto _ : state) verify_all();
  state.SetItemsProcessed(static_cast<int64_t>(verified) * state.iterations());
  state.counters["candidates"] = verified;
  state.counters["ties"] = ties / verified;
  state.counters["weak"] = weak / verified;
  state.counters["wrong_ties"] = wrong_ties;
  state.counters["wrong_weak"] = wrong_weak;
}

BENCHMARK(BM_Encode)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Decode)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Describe)->Unit(benchmark::kMicrosecond);
BENCHMARK(BM_Propose)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Pyramid)->Unit(benchmark::kMillisecond);
BENCHMARK(BM_Verify)->ArgName("kept")->Arg(0)->Arg(1)->Iterations(1)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace overtone

BENCHMARK_MAIN();
