// SPDX-License-Identifier: Apache-2.0
// What the outbox costs the robot, with the server gone: the latency of AddSubmap, processor time
// and bytes on disk per submap, resident memory with 200 MB waiting. Prints one table.
//   outbox_benchmark [DIRECTORY]   (default: a new one below the system's temporary directory)
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"
#include "overtone/client/mapping_client.h"
#include "overtone/tests/support/fake_host.h"
#include "overtone/tests/support/straight_mission.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

constexpr absl::Duration kPatience = absl::Minutes(5);
constexpr int kKeyframesPerSubmap = 20;

// The number behind `key` in a file of /proc.
double NumberIn(const char* path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.rfind(key + ":", 0) == 0) return std::stod(line.substr(key.size() + 1));
  }
  return -1;
}

double ProcessorSeconds() {
  rusage usage;
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

class Run {
 public:
  Run(const std::string& outbox_dir, int points_per_cloud, absl::Duration pause)
      : points_per_cloud_(points_per_cloud), pause_(pause) {
    MappingClientOptions options;
    options.server = "127.0.0.1:1";
    options.mission = TestMission();
    options.outbox_dir = outbox_dir;
    options.min_time_between_comparisons = absl::InfiniteDuration();
    auto client = MappingClient::Create(options, &host_);
    if (!client.ok()) {
      std::cerr << client.status() << "\n";
      std::exit(1);
    }
    client_ = *std::move(client);
    if (points_per_cloud_ > 0) cloud_ = WithClouds(StraightSubmap(0), 1, points_per_cloud_).clouds;
  }

  // Hands over `count` submaps and prints what each cost.
  void Measure(const std::string& name, int count) {
    std::vector<double> latency_us;
    const double written_before = NumberIn("/proc/self/io", "write_bytes");
    double processor_s = 0;
    for (int i = 0; i < count; ++i) {
      const Submap submap = Next();
      const double before_s = ProcessorSeconds();
      const absl::Time start = absl::Now();
      const absl::Status status = client_->AddSubmap(submap);
      latency_us.push_back(absl::ToDoubleMicroseconds(absl::Now() - start));
      if (!status.ok()) std::cerr << status << "\n";
      if (pause_ > absl::ZeroDuration()) {
        absl::SleepFor(pause_);  // a robot's pace, not synchronisation
      } else if (!client_->WaitUntilPersisted(kPatience).ok()) {
        std::exit(1);
      }
      processor_s += ProcessorSeconds() - before_s;
    }
    if (!client_->WaitUntilPersisted(kPatience).ok()) std::exit(1);
    const MappingClientStats stats = client_->Stats();
    client_.reset();  // the last checkpoint counts, too
    const double written = NumberIn("/proc/self/io", "write_bytes") - written_before;
    std::sort(latency_us.begin(), latency_us.end());
    absl::PrintF("| %s | %d | %.0f | %.0f | %.0f | %.2f | %.1f | %.2f |\n", name, count,
                 latency_us[count / 2], latency_us[count * 99 / 100], latency_us.back(),
                 1e3 * processor_s / count, static_cast<double>(stats.bytes_waiting) / count / 1e3,
                 written / static_cast<double>(stats.bytes_waiting));
  }

  void FillTo(int64_t bytes) {
    while (client_->Stats().bytes_waiting < bytes) {
      for (int i = 0; i < 10; ++i) {
        if (!client_->AddSubmap(Next()).ok()) std::exit(1);
      }
      if (!client_->WaitUntilPersisted(kPatience).ok()) std::exit(1);
    }
  }

  MappingClientStats Stats() const { return client_->Stats(); }

 private:
  // The clouds are all of the same points, shifted: other bytes, at no cost that is measured.
  Submap Next() {
    Submap submap = StraightSubmap(next_++, kKeyframesPerSubmap);
    if (points_per_cloud_ == 0) return submap;
    auto cloud = std::make_shared<PointCloud>(*cloud_[0].cloud);
    for (auto& point : cloud->points) point.x() += 0.01f * static_cast<float>(next_ % 1000);
    submap.clouds = {{submap.first_index, std::move(cloud)}};
    return submap;
  }

  const int points_per_cloud_;
  const absl::Duration pause_;
  FakeHost host_;
  std::vector<KeyframeCloud> cloud_;
  int64_t next_ = 0;
  std::unique_ptr<MappingClient> client_;
};

void PrintMemory(const std::string& outbox_dir) {
  constexpr double kMegabyte = 1024;
  const double before = NumberIn("/proc/self/status", "VmRSS") / kMegabyte;
  Run run(outbox_dir, 20'000, absl::ZeroDuration());
  run.FillTo(200'000'000);
  const MappingClientStats stats = run.Stats();
  absl::PrintF(
      "\nWaiting: %d submaps, %d clouds, %.0f MB. Resident: %.1f MB; before the client "
      "%.1f MB.\n",
      stats.submaps_waiting, stats.blobs_waiting, static_cast<double>(stats.bytes_waiting) / 1e6,
      NumberIn("/proc/self/status", "VmRSS") / kMegabyte, before);
}

}  // namespace
}  // namespace overtone

int main(int argc, char** argv) {
  using overtone::PrintMemory;
  using overtone::Run;
  const overtone::TemporaryDirectory temporary;
  const std::string base = argc > 1 ? argv[1] : temporary.path();
  const auto directory = [&](const char* name) { return base + "/" + name; };
  PrintMemory(directory("memory"));  // first: what malloc keeps of the other runs would count
  std::cout << "\nThe server is gone; 20 keyframes per submap.\n\n"
               "| | submaps | AddSubmap p50 us | p99 us | max us | CPU ms per submap | KB handed "
               "over per submap | bytes to disk per byte |\n|---|---|---|---|---|---|---|---|\n";
  Run("", 0, absl::ZeroDuration()).Measure("in memory, poses only", 5000);
  Run(directory("poses"), 0, absl::ZeroDuration()).Measure("on disk, poses only", 5000);
  Run(directory("slow"), 0, absl::Milliseconds(20)).Measure("on disk, poses only, 50 Hz", 500);
  Run(directory("clouds"), 20'000, absl::ZeroDuration())
      .Measure("on disk, a cloud of 20,000 points", 2000);
  Run(directory("clouds_slow"), 20'000, absl::Milliseconds(100))
      .Measure("on disk, a cloud of 20,000 points, 10 Hz", 400);
}
