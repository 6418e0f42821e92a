// SPDX-License-Identifier: Apache-2.0
// What a cloud costs on the wire and on the robot: bytes a point, ns a point to encode and decode,
// at 1 cm. Real clouds where they are there, else a planar scan and a room only.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "benchmark/benchmark.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/core/graph/point_cloud_io.h"

namespace overtone {
namespace {

using Clouds = std::vector<PointCloud>;

// A 2-D laser in a room of 20 x 10 m: 180 beams, one a degree, 1 cm of noise.
Clouds PlanarScans() {
  std::mt19937 random(1);
  std::normal_distribution<double> noise_m(0, 0.01);
  Clouds clouds(100);
  for (PointCloud& cloud : clouds) {
    for (int beam = 0; beam < 180; ++beam) {
      const double angle = (beam - 90) * M_PI / 180;
      const double range_m =
          std::min(10 / std::cos(angle), 5 / std::abs(std::sin(angle))) + noise_m(random);
      cloud.points.emplace_back(range_m * std::cos(angle), range_m * std::sin(angle), 0);
    }
  }
  return clouds;
}

// Floor and walls of the same room, 20,000 points at random with 1 cm of noise.
Clouds Rooms() {
  std::mt19937 random(1);
  std::normal_distribution<float> noise_m(0, 0.01f);
  std::uniform_real_distribution<float> unit(0, 1);
  Clouds clouds(5);
  for (PointCloud& cloud : clouds) {
    for (int i = 0; i < 20'000; ++i) {
      Eigen::Vector3f point(20 * unit(random), 10 * unit(random), 3 * unit(random));
      point[i % 3] = noise_m(random);
      cloud.points.push_back(point);
    }
  }
  return clouds;
}

Clouds Files(const std::string& folder, const std::string& extension) {
  const std::string path = OVERTONE_SOURCE_DIR "/../shared/data/" + folder;
  Clouds clouds;
  if (!std::filesystem::exists(path)) return clouds;
  for (const auto& entry : std::filesystem::directory_iterator(path)) {
    if (entry.path().extension() != extension) continue;
    auto cloud = ReadPointCloud(entry.path());
    if (!cloud.ok()) continue;
    cloud->intensities.clear();
    clouds.push_back(*std::move(cloud));
  }
  return clouds;
}

void Encode(benchmark::State& state, const Clouds& clouds) {
  double points = 0, bytes = 0;
  for (auto _ : state) {
    points = bytes = 0;
    for (const PointCloud& cloud : clouds) {
      bytes += static_cast<double>(EncodePointCloud(cloud, {})->size());
      points += static_cast<double>(cloud.size());
    }
  }
  state.counters["bytes/point"] = bytes / points;
  state.counters["bytes/cloud"] = bytes / static_cast<double>(clouds.size());
  state.counters["time/point"] = benchmark::Counter(
      points, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void Decode(benchmark::State& state, const Clouds& clouds) {
  std::vector<std::string> encoded;
  double points = 0;
  for (const PointCloud& cloud : clouds) {
    encoded.push_back(*EncodePointCloud(cloud, {}));
    points += static_cast<double>(cloud.size());
  }
  for (auto _ : state) {
    for (const std::string& bytes : encoded) benchmark::DoNotOptimize(DecodePointCloud(bytes));
  }
  state.counters["time/point"] = benchmark::Counter(
      points, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void Register(const std::string& name, const Clouds& clouds) {
  if (clouds.empty()) return;
  const auto encode = [clouds](benchmark::State& state) { Encode(state, clouds); };
  const auto decode = [clouds](benchmark::State& state) { Decode(state, clouds); };
  benchmark::RegisterBenchmark(("Encode/" + name).c_str(), encode)->Unit(benchmark::kMillisecond);
  benchmark::RegisterBenchmark(("Decode/" + name).c_str(), decode)->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace overtone

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  overtone::Register("planar_180_beams", overtone::PlanarScans());
  overtone::Register("room_20000", overtone::Rooms());
  overtone::Register("livox_314_scans", overtone::Files("hku_livox/Scans", ".pcd"));
  overtone::Register("dense_69000", overtone::Files("registration", ".ply"));
  benchmark::RunSpecifiedBenchmarks();
}
