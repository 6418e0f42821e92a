// SPDX-License-Identifier: Apache-2.0
// The noise of noisy_neighbour_test: one robot that sends all it can, valid, invalid and unwanted,
// and opens streams without end, until it is killed. It stands for another machine: its process
// gets what the server and the neighbour leave.
//   noisy_robot SERVER FIRST_RUN
// Answers each line of its standard input with how many messages it has sent.
#include <sys/resource.h>

#include <atomic>
#include <chrono>
#include <cstdint>
#include <iostream>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "overtone/proto/conversion/sha256.h"
#include "overtone/tests/proto/conversion_fixture.h"
#include "overtone/tests/support/plain_peers.h"

namespace overtone {
namespace {

using testing::MakeSubmap;
using testing::Uploader;

// One connection with everything on it.
class NoisyRobot {
 public:
  NoisyRobot(const std::string& server, int first_run)
      : stub_(v1::MappingService::NewStub(
            grpc::CreateChannel(server, grpc::InsecureChannelCredentials()))),
        next_run_(first_run) {
    threads_.emplace_back([this] { FloodSubmaps(); });
    threads_.emplace_back([this] { FloodInvalid(); });
    threads_.emplace_back([this] { FloodBlobs(); });
    threads_.emplace_back([this] { FloodStreams(); });
  }
  ~NoisyRobot() {
    stop_ = true;
    for (std::thread& thread : threads_) thread.join();
  }
  int64_t messages() const { return messages_; }

 private:
  // A stream ends after two seconds at the latest.
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
  std::atomic<int> next_run_;
  std::atomic<bool> stop_{false};
  std::atomic<int64_t> messages_{0};
  std::vector<std::thread> threads_;
};

}  // namespace
}  // namespace overtone

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  // Before there are other threads: those of gRPC are to have it, too.
  if (setpriority(PRIO_PROCESS, 0, 19) != 0) return 1;
  overtone::NoisyRobot robot(argv[1], std::stoi(argv[2]));
  for (std::string line; std::getline(std::cin, line);) std::cout << robot.messages() << std::endl;
}
