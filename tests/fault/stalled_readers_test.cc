// SPDX-License-Identifier: Apache-2.0
// What readers that do not read cost the server's memory.
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <thread>
#include <vector>

#include "gtest/gtest.h"
#include "overtone/tests/fault/fault_server.h"
#include "overtone/tests/proto/conversion_fixture.h"
#include "overtone/tests/support/plain_peers.h"

namespace overtone {
namespace {

using testing::FaultServer;
using testing::MakeSubmap;
using testing::Uploader;
using testing::Watcher;

const MissionId kAnna = {"anna", "run1"};
constexpr char kEveryKeyframeIsANode[] =
    "graph: {min_distance_m: 0, min_rotation_rad: 0, max_nodes: 30000}\n"
    "quotas: {max_messages_per_s: 0, max_bytes_per_s: 0, max_calls_per_s: 0, max_streams: 0}\n"
    "log_level: warning\n";

std::chrono::system_clock::time_point Long() {
  return std::chrono::system_clock::now() + std::chrono::minutes(20);
}

class StalledReadersTest : public ::testing::TestWithParam<int> {
 protected:
  // One submap after the other, each only when a reader that does read has seen a revision with
  // all before it; so every submap is a revision of its own.
  void Revisions(int count, int keyframes) {
    for (int i = 0; i < count; ++i) {
      ASSERT_TRUE(uploader_->Send(MakeSubmap(sequence_++, index_, keyframes)).has_ack());
      index_ += keyframes;
      const int64_t before = revisions_;
      while (revisions_ == before) {
        v1::WatchGraphResponse frame;
        ASSERT_TRUE(reader_->Read(frame));
        if (!frame.has_heartbeat()) ++revisions_;
      }
    }
  }

  FaultServer server_{"stalled_readers", kEveryKeyframeIsANode};
  std::unique_ptr<v1::MappingService::Stub> stub_ = server_.Connect();
  std::unique_ptr<Uploader> uploader_ = std::make_unique<Uploader>(*stub_, "mine", kAnna, Long());
  std::unique_ptr<Watcher> reader_;
  int64_t sequence_ = 0;
  int64_t index_ = 0;
  int64_t revisions_ = 0;
};

TEST_P(StalledReadersTest, ThirtyTwoStalledWatchersCostAtMostSixteenMebibytes) {
  constexpr int kStalled = 32;
  const char* asked_for = std::getenv("OVERTONE_TEST_STALLED_REVISIONS");
  if (asked_for == nullptr && GetParam() > 2000)
    GTEST_SKIP() << "OVERTONE_TEST_STALLED_REVISIONS=300";
  const int revisions = asked_for == nullptr ? 20 : std::atoi(asked_for);
  ASSERT_TRUE(uploader_->Read().has_ready());
  for (; index_ < GetParam(); index_ += 1000) {
    ASSERT_TRUE(uploader_->Send(MakeSubmap(sequence_++, index_, 1000)).has_ack());
  }
  reader_ = std::make_unique<Watcher>(*stub_, testing::WatchRequest("mine"), Long());
  Revisions(revisions, 1);  // until the history is full and the allocator has settled
  const double start = server_.ResidentMebibytes();
  Revisions(revisions, 1);
  const double without = server_.ResidentMebibytes();
  std::vector<std::unique_ptr<v1::MappingService::Stub>> stubs;
  std::vector<std::unique_ptr<Watcher>> stalled;
  for (int i = 0; i < kStalled; ++i) {
    stubs.push_back(server_.Connect());
    stalled.push_back(
        std::make_unique<Watcher>(*stubs.back(), testing::WatchRequest("mine"), Long()));
  }
  Revisions(revisions, 1);
  const double with = server_.ResidentMebibytes();
  std::printf("%d nodes: %.1f MiB; %d revisions: %+.1f MiB; and with %d stalled watchers: %+.1f\n",
              GetParam(), start, revisions, without - start, kStalled, with - without);
  EXPECT_LE(with - without, 16);
}

INSTANTIATE_TEST_SUITE_P(Nodes, StalledReadersTest, ::testing::Values(2000, 20000));

// Each rejection is an answer; nobody takes it.
TEST(StalledUploaders, UnreadAnswersAreBounded) {
  constexpr int kStalled = 32;
  FaultServer server("stalled_uploaders", kEveryKeyframeIsANode);
  v1::UploadSubmapsRequest bad;
  *bad.mutable_submap() = ToProto(MakeSubmap(0, 0, 1));
  bad.mutable_submap()->mutable_keyframes(0)->set_stamp_ns(-1);
  const auto flood = [&](int robot) {
    const auto stub = server.Connect();
    const MissionId mission = {"robot" + std::to_string(robot), "run1"};
    Uploader uploader(*stub, "mine", mission,
                      std::chrono::system_clock::now() + std::chrono::seconds(15));
    // Blocks for good when the server stops reading, until the call's deadline.
    while (uploader.Write(bad)) {
    }
  };
  flood(0);
  const double before = server.ResidentMebibytes();
  std::vector<std::thread> threads;
  for (int i = 1; i <= kStalled; ++i) threads.emplace_back(flood, i);
  for (std::thread& thread : threads) thread.join();
  const double peak = server.PeakMebibytes();
  std::printf("%d uploads that take no answers: %+.1f MiB at most\n", kStalled, peak - before);
  // An upload's window for each, and as much in gRPC's hands.
  EXPECT_LE(peak - before, kStalled * 8);
}

}  // namespace
}  // namespace overtone
