// SPDX-License-Identifier: Apache-2.0
// What the server spends on looking for places: a descriptor of a cloud, one comparison, a search
// among many. The places are random ones; each search asks for one of them, turned.
#include <cmath>
#include <map>
#include <memory>
#include <random>

#include "benchmark/benchmark.h"
#include "overtone/core/place_recognition/scan_context_index.h"

namespace overtone {
namespace {

PointCloud RandomPlace(unsigned seed, int things) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> unit(0, 1);
  // What makes places differ more than the order of their things: wide or narrow, high or low.
  const float width = 4 * std::pow(15.f, unit(random));
  const float height = 1 + 9 * unit(random);
  PointCloud cloud;
  for (int i = 0; i < things; ++i) {
    const float heading = 2 * M_PI * unit(random);
    const float range = 1.5f + width * unit(random);
    cloud.points.emplace_back(range * std::cos(heading), range * std::sin(heading),
                              height * unit(random));
  }
  return cloud;
}

ScanContext Describe(const PointCloud& cloud) {
  return ComputeScanContext(cloud, Eigen::Quaterniond::Identity(), {});
}

PointCloud Turned(PointCloud cloud, float yaw_rad) {
  const Eigen::Matrix3f turn(Eigen::AngleAxisf(yaw_rad, Eigen::Vector3f::UnitZ()));
  for (Eigen::Vector3f& point : cloud.points) point = turn * point;
  return cloud;
}

void BM_Describe(benchmark::State& state) {
  const PointCloud cloud = RandomPlace(1, static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(Describe(cloud));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(BM_Describe)->Arg(5'000)->Arg(50'000)->Unit(benchmark::kMicrosecond);

void BM_Compare(benchmark::State& state) {
  const ScanContext a = Describe(RandomPlace(1, 600));
  const ScanContext b = Describe(RandomPlace(2, 600));
  for (auto _ : state) benchmark::DoNotOptimize(CompareScanContexts(a, b, {}));
}
BENCHMARK(BM_Compare)->Unit(benchmark::kMicrosecond);

const ScanContextIndex& Index(int places) {
  static std::map<int, std::unique_ptr<ScanContextIndex>> indices;
  auto& index = indices[places];
  if (index == nullptr) {
    index = std::make_unique<ScanContextIndex>(ScanContextOptions());
    for (int place = 0; place < places; ++place) index->Add(Describe(RandomPlace(place, 600)));
  }
  return *index;
}

void BM_Search(benchmark::State& state) {
  const int places = static_cast<int>(state.range(0));
  const ScanContextIndex& index = Index(places);
  std::vector<ScanContext> queries;
  for (int i = 0; i < 64; ++i) {
    queries.push_back(Describe(Turned(RandomPlace(i * (places / 64), 600), 0.1f * i)));
  }
  int64_t asked = 0, right = 0;
  for (auto _ : state) {
    const int i = static_cast<int>(asked++ % 64);
    const auto matches = index.Search(queries[i], 5, [](int) { return true; });
    right += matches[0].place == i * (places / 64);
  }
  state.SetItemsProcessed(state.iterations());
  state.counters["right"] = static_cast<double>(right) / asked;
}
BENCHMARK(BM_Search)->Arg(1'000)->Arg(5'000)->Arg(20'000)->Unit(benchmark::kMicrosecond);

// Each place added to an index that grows to so many.
void BM_Add(benchmark::State& state) {
  const int places = static_cast<int>(state.range(0));
  std::vector<ScanContext> contexts;
  for (int place = 0; place < places; ++place)
    contexts.push_back(Describe(RandomPlace(place, 600)));
  for (auto _ : state) {
    ScanContextIndex index({});
    for (const ScanContext& context : contexts) index.Add(context);
  }
  state.SetItemsProcessed(state.iterations() * places);
}
BENCHMARK(BM_Add)->Arg(1'000)->Arg(5'000)->Arg(20'000)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace overtone

BENCHMARK_MAIN();
