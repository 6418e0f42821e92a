// SPDX-License-Identifier: Apache-2.0
// A robot that sends all it can, and what its neighbour notices. Both talk to a server with its
// maps on disk; blocks with and without the noise alternate, so that the machine's moods hit both.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "gtest/gtest.h"
#include "overtone/proto/conversion/sha256.h"
#include "overtone/tests/fault/fault_server.h"
#include "overtone/tests/proto/conversion_fixture.h"
#include "overtone/tests/support/plain_peers.h"

namespace overtone {
namespace {

using testing::FaultServer;
using testing::MakeSubmap;
using testing::Uploader;
using Clock = std::chrono::steady_clock;

constexpr int kBlocks = 8;
constexpr int kSubmapsPerBlock = 60;
// Until the noisy robot has used up what may come at once after a quiet time.
constexpr int kSubmapsDuringBurst = 40;
// The neighbour's: a submap of ten keyframes. Faster than any robot, so that it ends.
constexpr auto kPeriod = std::chrono::milliseconds(40);

std::chrono::system_clock::time_point Long() {
  return std::chrono::system_clock::now() + std::chrono::minutes(10);
}

// One connection with everything on it; goes on until it is destroyed.
class NoisyRobot {
 public:
  explicit NoisyRobot(const FaultServer& server) : stub_(server.Connect()) {
    Run([this] { FloodSubmaps(); });
    Run([this] { FloodInvalid(); });
    Run([this] { FloodBlobs(); });
    Run([this] { FloodStreams(); });
  }
  ~NoisyRobot() {
    stop_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  int64_t messages() const { return messages_; }

 private:
  static inline std::atomic<int> next_run_{0};

  // It is another machine that makes the noise: here it gets what the server and the neighbour
  // leave.
  void Run(std::function<void()> flood) {
    threads_.emplace_back([flood = std::move(flood)] {
      setpriority(PRIO_PROCESS, gettid(), 19);
      flood();
    });
  }

  // A stream ends with this block.
  std::unique_ptr<Uploader> Open() {
    const MissionId mission = {"noisy", "run" + std::to_string(next_run_++)};
    return std::make_unique<Uploader>(*stub_, "mine", mission,
                                      std::chrono::system_clock::now() + std::chrono::seconds(2));
  }
  void Write(Uploader& uploader, const v1::UploadSubmapsRequest& request, bool& open) {
    open = uploader.Write(request);
    ++messages_;
  }

  void FloodSubmaps() {
    while (!stop_) {
      const auto uploader = Open();
      std::thread reader([&] {
        while (uploader->Read().frame_case() != v1::UploadSubmapsResponse::FRAME_NOT_SET) {
        }
      });
      bool open = true;
      for (int i = 0; open && !stop_; ++i) {
        v1::UploadSubmapsRequest request;
        *request.mutable_submap() = ToProto(MakeSubmap(i, i * 10, 10));
        Write(*uploader, request, open);
      }
      uploader->Cancel();
      reader.join();
    }
  }
  void FloodInvalid() {
    v1::UploadSubmapsRequest request;
    *request.mutable_submap() = ToProto(MakeSubmap(0, 0, 500));
    request.mutable_submap()->mutable_keyframes(499)->set_stamp_ns(-1);
    FloodOne(request);
  }
  void FloodBlobs() {
    v1::UploadSubmapsRequest request;
    request.mutable_blob()->set_sha256(Sha256("unwanted"));
    request.mutable_blob()->set_data(std::string(512 << 10, 'x'));
    FloodOne(request);
  }
  void FloodOne(const v1::UploadSubmapsRequest& request) {
    while (!stop_) {
      const auto uploader = Open();
      for (bool open = true; open && !stop_;) Write(*uploader, request, open);
    }
  }
  // Keeps opening until it is refused, and then some.
  void FloodStreams() {
    while (!stop_) {
      std::vector<std::unique_ptr<Uploader>> open;
      for (int i = 0; i < 100 && !stop_; ++i) open.push_back(Open());
      for (const auto& uploader : open) {
        if (!stop_) uploader->Read();
      }
    }
  }

  const std::unique_ptr<v1::MappingService::Stub> stub_;
  std::atomic<bool> stop_{false};
  std::atomic<int64_t> messages_{0};
  std::vector<std::thread> threads_;
};

class Neighbour {
 public:
  explicit Neighbour(const FaultServer& server)
      : stub_(server.Connect()), uploader_(*stub_, "mine", {"calm", "run1"}, Long()) {
    EXPECT_TRUE(uploader_.Read().has_ready());
  }

  // Milliseconds until each acknowledgement.
  void Upload(int submaps, std::vector<double>& latencies) {
    Clock::time_point due = Clock::now();
    for (int i = 0; i < submaps; ++i, due += kPeriod) {
      std::this_thread::sleep_until(due);
      const Submap submap = MakeSubmap(sequence_, sequence_ * 10, 10);
      const Clock::time_point sent = Clock::now();
      ASSERT_TRUE(uploader_.Send(submap).has_ack());
      latencies.push_back(std::chrono::duration<double, std::milli>(Clock::now() - sent).count());
      ++sequence_;
    }
  }

 private:
  const std::unique_ptr<v1::MappingService::Stub> stub_;
  Uploader uploader_;
  int64_t sequence_ = 0;
};

double Quantile(std::vector<double> values, double q) {
  std::sort(values.begin(), values.end());
  return values[static_cast<size_t>(q * static_cast<double>(values.size() - 1))];
}

TEST(NoisyNeighbour, TheNeighboursAcknowledgementsHardlyNotice) {
  FaultServer server("noisy_neighbour", "log_level: warning\n");
  Neighbour neighbour(server);
  std::vector<double> alone;
  std::vector<double> beside;
  std::vector<double> warm_up;
  int64_t messages = 0;
  neighbour.Upload(kSubmapsPerBlock, warm_up);
  for (int block = 0; block < kBlocks; ++block) {
    neighbour.Upload(kSubmapsPerBlock, alone);
    NoisyRobot noisy(server);
    neighbour.Upload(kSubmapsDuringBurst, warm_up);
    const int64_t before = noisy.messages();
    neighbour.Upload(kSubmapsPerBlock, beside);
    messages += noisy.messages() - before;
  }
  const double seconds =
      kBlocks * kSubmapsPerBlock * std::chrono::duration<double>(kPeriod).count();
  std::printf("acknowledged after    alone    beside  ratio   (the noisy one: %.0f messages/s)\n",
              static_cast<double>(messages) / seconds);
  for (const double q : {0.5, 0.9, 0.99}) {
    const double a = Quantile(alone, q);
    const double b = Quantile(beside, q);
    std::printf("p%-16.0f %8.2f  %8.2f  %5.2f   ms\n", 100 * q, a, b, b / a);
  }
  // The figure to hold is 1.2; what a test on a shared machine can insist on is less.
  EXPECT_LE(Quantile(beside, 0.5), 3 * Quantile(alone, 0.5));
}

}  // namespace
}  // namespace overtone
