// SPDX-License-Identifier: Apache-2.0
// What durability costs: submaps acknowledged per second and how long each takes, by the number of
// missions that upload at once, on disk and in memory, beside a plain write and fsync of the same
// bytes; how long a restart takes; bytes on disk. In the folder that STORE_FOLDER names, or /tmp.
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/synchronization/blocking_counter.h"
#include "absl/time/clock.h"
#include "benchmark/benchmark.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/services/mapping_server/submap_digest.h"
#include "overtone/services/mapping_server/submap_store/log_compression.h"
#include "overtone/services/mapping_server/submap_store/sqlite_submap_store.h"
#include "spdlog/spdlog.h"

namespace overtone {
namespace {

constexpr int kKeyframes = 20;  // of a submap: one every few seconds of driving

std::string FreshPath() {
  static int count = 0;
  const char* folder = std::getenv("STORE_FOLDER");
  const std::string path = std::string(folder == nullptr ? "/tmp" : folder) +
                           "/overtone_store_benchmark_" + std::to_string(getpid()) + "_" +
                           std::to_string(count++);
  std::filesystem::create_directories(path);
  return path;
}

// Odometry with its noise: no two keyframes alike, and no two covariances unless `one_covariance`.
SubmapRecord MakeRecord(const MissionId& mission, int64_t sequence, bool one_covariance = false) {
  std::mt19937 random(static_cast<unsigned>(std::hash<std::string>()(mission.robot) + sequence));
  std::normal_distribution<double> noise;
  Submap submap;
  submap.sequence = sequence;
  submap.first_index = kKeyframes * sequence;
  for (int i = 0; i < kKeyframes; ++i) {
    const auto index = static_cast<double>(submap.first_index + i);
    Keyframe keyframe;
    keyframe.stamp = {static_cast<int64_t>(1e9 * (index + 1)) +
                      static_cast<int64_t>(random() % 1000)};
    keyframe.mission_from_body =
        Rigid3d(ExpSO3(Eigen::Vector3d(0.01 * noise(random), 0.01 * noise(random), 0.1 * index)),
                Eigen::Vector3d(index + 0.01 * noise(random), noise(random), 0.1 * noise(random)));
    if (one_covariance && i > 0) {
      keyframe.motion_covariance = submap.keyframes[0].motion_covariance;
      submap.keyframes.push_back(keyframe);
      continue;
    }
    Matrix6d root = Matrix6d::NullaryExpr([&] { return 0.001 * noise(random); });
    keyframe.motion_covariance = root * root.transpose() + 1e-6 * Matrix6d::Identity();
    submap.keyframes.push_back(keyframe);
  }
  std::string bytes = DeterministicBytes(ToProto(submap));
  std::string digest = Sha256(bytes);
  return {mission, std::make_shared<const Submap>(std::move(submap)), std::move(bytes),
          std::move(digest)};
}

MissionId Mission(int64_t number) { return {"robot" + std::to_string(number), "run"}; }

SubmapStore::Sink NoSink() {
  SubmapStore::Sink sink;
  sink.on_submap = [](const MissionId&, std::shared_ptr<const Submap>) {};
  sink.on_loop_closure = [](const LoopClosure&) {};
  sink.on_finding = [](const std::string&) {};
  sink.on_cloud = [](const MissionId&, int64_t, const std::string&) {};
  sink.on_cloud_gone = [](const MissionId&, int64_t) {};
  return sink;
}

void ReportLatency(benchmark::State& state, std::vector<double> latency_s) {
  std::sort(latency_s.begin(), latency_s.end());
  state.counters["p50_ms"] = 1e3 * latency_s[latency_s.size() / 2];
  state.counters["p99_ms"] = 1e3 * latency_s[latency_s.size() * 99 / 100];
}

// A mission sends its next submap when the last one is acknowledged, `window` at a time.
void Upload(SubmapStore& store, const std::vector<SubmapRecord>& records, int window,
            std::vector<double>& latency_s) {
  for (size_t first = 0; first < records.size(); first += window) {
    const size_t end = std::min(records.size(), first + window);
    absl::BlockingCounter left(static_cast<int>(end - first));
    for (size_t i = first; i < end; ++i) {
      const absl::Time start = absl::Now();
      store.Append(records[i], [&, i, start](const absl::StatusOr<AppendResult>& result) {
        if (!result.ok()) std::abort();
        latency_s[i] = absl::ToDoubleSeconds(absl::Now() - start);
        left.DecrementCount();
      });
    }
    left.Wait();
  }
}

// missions, window, on disk
void BM_Append(benchmark::State& state) {
  const int64_t missions = state.range(0);
  const int window = static_cast<int>(state.range(1));
  const bool on_disk = state.range(2) != 0;
  const int64_t submaps = std::max<int64_t>(64, 1024 / missions);  // of each
  std::vector<double> all;
  int64_t bytes = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const std::string folder = FreshPath();
    auto store = *SqliteSubmapStore::Open(on_disk ? folder + "/map.db" : ":memory:", ServerLimits(),
                                          NoSink());
    std::vector<std::vector<SubmapRecord>> records(missions);
    std::vector<std::vector<double>> latency_s(missions, std::vector<double>(submaps));
    bytes = 0;
    for (int64_t mission = 0; mission < missions; ++mission) {
      for (int64_t i = 0; i < submaps; ++i) {
        records[mission].push_back(MakeRecord(Mission(mission), i));
        bytes += static_cast<int64_t>(records[mission].back().bytes.size());
      }
    }
    state.ResumeTiming();
    std::vector<std::thread> robots;
    for (int64_t mission = 0; mission < missions; ++mission) {
      robots.emplace_back(
          [&, mission] { Upload(*store, records[mission], window, latency_s[mission]); });
    }
    for (std::thread& robot : robots) robot.join();
    state.PauseTiming();
    for (const auto& of_mission : latency_s) {
      all.insert(all.end(), of_mission.begin(), of_mission.end());
    }
    store.reset();
    if (on_disk) {
      state.counters["disk_bytes_per_submap"] =
          static_cast<double>(std::filesystem::file_size(folder + "/map.db")) /
          static_cast<double>(missions * submaps);
    }
    std::filesystem::remove_all(folder);
    state.ResumeTiming();
  }
  state.SetItemsProcessed(state.iterations() * missions * submaps);
  state.SetBytesProcessed(state.iterations() * bytes);
  state.counters["message_bytes"] =
      static_cast<double>(bytes) / static_cast<double>(missions * submaps);
  ReportLatency(state, std::move(all));
}
BENCHMARK(BM_Append)
    ->ArgNames({"missions", "window", "disk"})
    ->ArgsProduct({{1, 8, 32}, {1, 16}, {0, 1}})
    ->UseRealTime()
    ->Iterations(2)
    ->Unit(benchmark::kMillisecond);

// The same bytes at the end of one file, synced after every `submaps` of them.
void BM_WriteAndFsync(benchmark::State& state) {
  const int64_t submaps = state.range(0);
  constexpr int64_t kTotal = 1024;
  std::vector<std::string> records;
  for (int64_t i = 0; i < kTotal; ++i) records.push_back(MakeRecord(Mission(0), i).bytes);
  const std::string folder = FreshPath();
  std::vector<double> latency_s;
  int64_t bytes = 0;
  const int fd = open((folder + "/log").c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  for (auto _ : state) {
    for (int64_t i = 0; i < kTotal; i += submaps) {
      const absl::Time start = absl::Now();
      for (int64_t j = i; j < std::min(kTotal, i + submaps); ++j) {
        bytes += write(fd, records[j].data(), records[j].size());
      }
      if (fsync(fd) != 0) std::abort();
      latency_s.push_back(absl::ToDoubleSeconds(absl::Now() - start));
    }
  }
  close(fd);
  std::filesystem::remove_all(folder);
  state.SetItemsProcessed(state.iterations() * kTotal);
  state.SetBytesProcessed(bytes);
  ReportLatency(state, std::move(latency_s));
}
BENCHMARK(BM_WriteAndFsync)
    ->ArgName("submaps_per_fsync")
    ->Arg(1)
    ->Arg(8)
    ->Arg(32)
    ->Arg(512)
    ->UseRealTime()
    ->Iterations(2)
    ->Unit(benchmark::kMillisecond);

void BM_Restart(benchmark::State& state) {
  const std::string folder = FreshPath();
  const std::string path = folder + "/map.db";
  {
    auto store = *SqliteSubmapStore::Open(path, ServerLimits(), NoSink());
    std::vector<SubmapRecord> records;
    for (int64_t i = 0; i < state.range(0); ++i) {
      records.push_back(MakeRecord(Mission(i % 4), i / 4));
    }
    std::vector<double> latency_s(records.size());
    Upload(*store, records, 64, latency_s);
  }
  for (auto _ : state) {
    auto store = *SqliteSubmapStore::Open(path, ServerLimits(), NoSink());
    if (!store->Replay().ok()) std::abort();
    state.PauseTiming();
    store.reset();
    state.ResumeTiming();
  }
  std::filesystem::remove_all(folder);
}
BENCHMARK(BM_Restart)
    ->ArgName("submaps")
    ->Arg(1000)
    ->Arg(10000)
    ->UseRealTime()
    ->Iterations(3)
    ->Unit(benchmark::kMillisecond);

void BM_Compress(benchmark::State& state) {
  const std::string bytes = MakeRecord(Mission(0), 0, state.range(0) != 0).bytes;
  size_t compressed = 0;
  for (auto _ : state) compressed = EncodeLogBytes(bytes).bytes.size();
  state.SetBytesProcessed(state.iterations() * static_cast<int64_t>(bytes.size()));
  state.counters["bytes"] = static_cast<double>(bytes.size());
  state.counters["compressed"] = static_cast<double>(compressed);
}
BENCHMARK(BM_Compress)->ArgName("one_covariance")->Arg(0)->Arg(1);

}  // namespace
}  // namespace overtone

int main(int argc, char** argv) {
  spdlog::set_level(spdlog::level::warn);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}
