// SPDX-License-Identifier: Apache-2.0
// SIGTERM while peers do all that can hold a server up.
#include <signal.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/time/clock.h"
#include "gtest/gtest.h"
#include "overtone/client/cli/admin_client.h"
#include "overtone/tests/fault/fault_server.h"
#include "overtone/tests/proto/conversion_fixture.h"
#include "overtone/tests/support/plain_peers.h"

namespace overtone {
namespace {

using testing::FaultServer;
using testing::MakeSubmap;
using testing::Uploader;
using testing::Watcher;

constexpr absl::Duration kPatience = absl::Seconds(60);

// Sends submaps as fast as they are taken, reads answers or does not, and ends with the stream.
class Peer {
 public:
  Peer(const FaultServer& server, int number, bool reads)
      : mission_{"robot" + std::to_string(number), "run1"},
        stub_(server.Connect()),
        uploader_(*stub_, "mine", mission_),
        writer_([this] {
          v1::UploadSubmapsRequest request;
          for (int i = 0;; ++i) {
            *request.mutable_submap() = ToProto(MakeSubmap(i, i, 1));
            if (!uploader_.Write(request)) return;
          }
        }) {
    if (!reads) return;
    EXPECT_TRUE(uploader_.Read().has_ready());
    reader_ = std::thread([this] {
      for (auto answer = uploader_.Read(); answer.has_ack(); answer = uploader_.Read()) {
        acknowledged_ = answer.ack().durable_through_sequence();
      }
    });
  }
  ~Peer() {
    uploader_.Cancel();
    writer_.join();
    if (reader_.joinable()) reader_.join();
  }
  const MissionId& mission() const { return mission_; }
  int64_t acknowledged() const { return acknowledged_; }
  // When the server is gone.
  grpc::Status End() {
    writer_.join();
    reader_.join();
    writer_ = std::thread([] {});
    return uploader_.End();
  }

 private:
  const MissionId mission_;
  const std::unique_ptr<v1::MappingService::Stub> stub_;
  Uploader uploader_;
  std::atomic<int64_t> acknowledged_{-1};
  std::thread writer_;
  std::thread reader_;
};

uint64_t Revision(FaultServer& server) {
  const auto map = AdminClient(server.process().address(), kPatience).GetMap("mine");
  EXPECT_TRUE(map.ok()) << map.status();
  return map.ok() ? map->revision() : 0;
}

int64_t NextSequence(v1::MappingService::Stub& stub, const MissionId& mission) {
  v1::GetUploadStateRequest request;
  request.set_map("mine");
  *request.mutable_mission() = ToProto(mission);
  v1::GetUploadStateResponse response;
  grpc::ClientContext context;
  EXPECT_TRUE(stub.GetUploadState(&context, request, &response).ok());
  return response.next_sequence();
}

TEST(ServerShutdown, TakesAtMostTenSecondsWhateverPeersDoAndLosesNothing) {
  FaultServer server("shutdown",
                     "graph: {min_distance_m: 0, min_rotation_rad: 0}\n"
                     "log_level: warning\n");
  std::vector<std::unique_ptr<Peer>> peers;
  for (int i = 0; i < 4; ++i) peers.push_back(std::make_unique<Peer>(server, i, /*reads=*/true));
  std::vector<std::unique_ptr<Peer>> stalled;
  for (int i = 4; i < 8; ++i) stalled.push_back(std::make_unique<Peer>(server, i, false));
  std::vector<std::unique_ptr<v1::MappingService::Stub>> stubs;
  std::vector<std::unique_ptr<Watcher>> watchers;
  for (int i = 0; i < 32; ++i) {
    stubs.push_back(server.Connect());
    watchers.push_back(std::make_unique<Watcher>(*stubs[i], testing::WatchRequest("mine")));
  }
  for (const auto& peer : peers) {
    const absl::Time patience = absl::Now() + kPatience;
    while (peer->acknowledged() < 50 && absl::Now() < patience) std::this_thread::yield();
  }

  const uint64_t revision = Revision(server);
  const absl::Time begin = absl::Now();
  kill(server.process().pid(), SIGTERM);
  ASSERT_FALSE(server.process().CheckAlive(kPatience).ok());
  const double seconds = absl::ToDoubleSeconds(absl::Now() - begin);
  EXPECT_TRUE(server.process().Stop().ok());  // ended with code 0
  std::printf("ended %.2f s after SIGTERM\n", seconds);
  EXPECT_LE(seconds, 10);

  for (const auto& peer : peers) {
    EXPECT_EQ(peer->End().error_code(), grpc::StatusCode::UNAVAILABLE);
  }
  server.Start();
  EXPECT_GE(Revision(server), revision) << "the last checkpoint was not stored";
  const auto stub = server.Connect();
  for (const auto& peer : peers) {
    EXPECT_EQ(NextSequence(*stub, peer->mission()), peer->acknowledged() + 1)
        << ToString(peer->mission());
  }
}

}  // namespace
}  // namespace overtone
