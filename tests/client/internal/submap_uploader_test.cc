// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/submap_uploader.h"

#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/synchronization/notification.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/internal/channel.h"
#include "overtone/tests/support/scripted_mapping_server.h"
#include "overtone/tests/support/straight_mission.h"

namespace overtone {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Upload = ScriptedMappingServer::Upload;
using Script = ScriptedMappingServer::Script;

constexpr absl::Duration kPatience = absl::Seconds(20);

// An uploader with its outbox, and what it reports.
class Robot {
 public:
  Robot(const std::string& address, int num_submaps,
        absl::Duration stall_timeout = absl::Minutes(5), TokenBucket* bucket = nullptr)
      : outbox_(64 << 20) {
    for (int64_t i = 0; i < num_submaps; ++i) Push(i);
    MappingClientOptions options;
    options.server = address;
    options.initial_backoff = absl::Milliseconds(2);
    options.max_backoff = absl::Milliseconds(20);
    stub_ = v1::MappingService::NewStub(CreateChannel(options));
    uploader_ = std::make_unique<SubmapUploader>(
        stub_.get(),
        SubmapUploader::Settings{"town", TestMission(),
                                 Backoff(options.initial_backoff, options.max_backoff, /*seed=*/1),
                                 stall_timeout, bucket},
        &outbox_, &counters_, Logger([this](LogLevel, absl::string_view line) {
          absl::MutexLock lock(&mutex_);
          log_.emplace_back(line);
        }),
        SubmapUploader::Listener{[this](int64_t sequence, const absl::Status& reason) {
                                   absl::MutexLock lock(&mutex_);
                                   refused_.emplace_back(sequence, reason.code());
                                   outbox_.RemoveSubmapsFrom(sequence);
                                 },
                                 [this] {
                                   absl::MutexLock lock(&mutex_);
                                   ++drops_;
                                 },
                                 [this](int64_t first_waiting, const absl::Status&) {
                                   absl::MutexLock lock(&mutex_);
                                   gaps_.push_back(first_waiting);
                                 }});
  }

  void Push(int64_t sequence, std::vector<WaitingBlob> blobs = {}) {
    v1::Submap submap;
    submap.set_sequence(sequence);
    submap.set_first_index(200);
    for (WaitingBlob& blob : blobs) {
      blob.sequence = sequence;
      v1::CloudReference& cloud = *submap.add_clouds();
      cloud.set_sha256(blob.sha256);
      cloud.set_encoded_bytes(static_cast<int64_t>(blob.bytes->size()));
    }
    const auto bytes = std::make_shared<const std::string>(submap.SerializeAsString());
    ASSERT_TRUE(outbox_.PushSubmap({sequence, 10 * sequence, bytes}, std::move(blobs)).ok());
    if (uploader_ != nullptr) uploader_->Notify();
  }

  SubmapOutbox& outbox() { return outbox_; }
  std::vector<std::pair<int64_t, absl::StatusCode>> refused() {
    absl::MutexLock lock(&mutex_);
    return refused_;
  }
  int drops() {
    absl::MutexLock lock(&mutex_);
    return drops_;
  }
  std::vector<int64_t> gaps() {
    absl::MutexLock lock(&mutex_);
    return gaps_;
  }
  std::vector<std::string> log() {
    absl::MutexLock lock(&mutex_);
    return log_;
  }
  void Stop() { uploader_.reset(); }

 private:
  SubmapOutbox outbox_;
  TrafficCounters counters_;
  absl::Mutex mutex_;
  std::vector<std::pair<int64_t, absl::StatusCode>> refused_ ABSL_GUARDED_BY(mutex_);
  int drops_ ABSL_GUARDED_BY(mutex_) = 0;
  std::vector<int64_t> gaps_ ABSL_GUARDED_BY(mutex_);
  std::vector<std::string> log_ ABSL_GUARDED_BY(mutex_);
  std::unique_ptr<v1::MappingService::Stub> stub_;
  std::unique_ptr<SubmapUploader> uploader_;
};

WaitingBlob Blob(const std::string& content, size_t size) {
  return {0, content, std::make_shared<const std::string>(size, content[0])};
}

TEST(SubmapUploader, SendsTheHeaderAndThenFromWhereReadySays) {
  ScriptedMappingServer server({[](int, Upload& upload) {
    upload.Ready(2);
    return upload.AcknowledgeEverything();
  }});
  Robot robot(server.address(), /*num_submaps=*/5);
  ASSERT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  EXPECT_THAT(server.Received(), ElementsAre(2, 3, 4));
  EXPECT_EQ(server.Headers()[0].map(), "town");
  EXPECT_EQ(server.Headers()[0].mission().robot(), TestMission().robot);
  EXPECT_EQ(server.Headers()[0].mission().mission(), TestMission().mission);
  EXPECT_EQ(robot.outbox().Level().submaps_acknowledged, 5);
}

TEST(SubmapUploader, SendsWhatComesLater) {
  ScriptedMappingServer server({[](int, Upload& upload) {
    upload.Ready(0);
    return upload.AcknowledgeEverything();
  }});
  Robot robot(server.address(), /*num_submaps=*/0);
  for (int64_t i = 0; i < 20; ++i) {
    robot.Push(i);
    ASSERT_TRUE(server.AwaitReceived(i + 1));
  }
  EXPECT_TRUE(robot.outbox().AwaitEmpty(kPatience));
}

// Room for two: the third must not leave before the first is acknowledged.
TEST(SubmapUploader, NeverHasMoreUnderwayThanTheWindowHolds) {
  ScriptedMappingServer* server_pointer = nullptr;
  bool third_came_early = true;
  ScriptedMappingServer server({[&](int, Upload& upload) {
    upload.Ready(0, /*window_bytes=*/12);  // submap 0 takes 3 bytes, each other one 5
    upload.Read();
    upload.Read();
    std::thread third([&] { upload.Read(); });
    third_came_early = server_pointer->AwaitReceived(3, absl::Milliseconds(100));
    upload.Ack(0);
    third.join();
    upload.Ack(2);
    return upload.AcknowledgeEverything();
  }});
  server_pointer = &server;
  Robot robot(server.address(), /*num_submaps=*/6);
  EXPECT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  EXPECT_FALSE(third_came_early);
  EXPECT_THAT(server.Received(), ElementsAre(0, 1, 2, 3, 4, 5));
}

TEST(SubmapUploader, ASubmapLargerThanTheWindowStillGoesOutAlone) {
  ScriptedMappingServer server({[](int, Upload& upload) {
    upload.Ready(0, /*window_bytes=*/1);
    return upload.AcknowledgeEverything();
  }});
  Robot robot(server.address(), /*num_submaps=*/5);
  EXPECT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  EXPECT_THAT(server.Received(), ElementsAre(0, 1, 2, 3, 4));
}

// The stream breaks with three submaps under way, one of which was stored without its
// acknowledgement getting through.
TEST(SubmapUploader, NothingIsLostAndNothingStoredIsSentAgainWhenTheStreamBreaksMidway) {
  ScriptedMappingServer server({[](int call, Upload& upload) {
    if (call == 0) {
      upload.Ready(0);
      upload.Read();
      upload.Ack(0);
      upload.Read();
      upload.Read();
      return grpc::Status(grpc::StatusCode::UNAVAILABLE, "cable cut");
    }
    upload.Ready(2);
    return upload.AcknowledgeEverything();
  }});
  Robot robot(server.address(), /*num_submaps=*/5);
  ASSERT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  EXPECT_THAT(server.Received(), ElementsAre(0, 1, 2, 2, 3, 4));
  EXPECT_EQ(server.Headers().size(), 2);
  EXPECT_TRUE(robot.refused().empty());
}

TEST(SubmapUploader, ComesBackAfterEveryKindOfEnd) {
  ScriptedMappingServer server({[](int call, Upload& upload) {
    if (call < 16) return grpc::Status(static_cast<grpc::StatusCode>(call), "call ended");
    upload.Ready(0);
    return upload.AcknowledgeEverything();
  }});
  Robot robot(server.address(), /*num_submaps=*/1);
  EXPECT_TRUE(robot.outbox().AwaitEmpty(kPatience));
}

TEST(SubmapUploader, ARetryableRejectIsSentAgainAndNotReported) {
  ScriptedMappingServer server({[](int call, Upload& upload) {
    upload.Ready(0);
    if (call == 0) {
      upload.Reject(upload.Read(), grpc::StatusCode::RESOURCE_EXHAUSTED, "store: full");
      while (upload.Read() >= 0) {
      }
      return grpc::Status::OK;
    }
    return upload.AcknowledgeEverything();
  }});
  Robot robot(server.address(), /*num_submaps=*/1);
  EXPECT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  EXPECT_TRUE(robot.refused().empty());
  EXPECT_GE(server.Headers().size(), 2);
}

TEST(SubmapUploader, AGapIsResolvedByTheNextReady) {
  ScriptedMappingServer server({[](int call, Upload& upload) {
    if (call == 0) {
      upload.Ready(2);
      upload.Read();
      upload.Reject(2, grpc::StatusCode::OUT_OF_RANGE, "sequence: expected 3", 3);
      while (upload.Read() >= 0) {
      }
      return grpc::Status::OK;
    }
    upload.Ready(3);
    return upload.AcknowledgeEverything();
  }});
  Robot robot(server.address(), /*num_submaps=*/5);
  EXPECT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  EXPECT_TRUE(robot.refused().empty());
}

TEST(SubmapUploader, AFinalRejectIsReportedOnce) {
  ScriptedMappingServer server({[](int call, Upload& upload) {
    if (call == 0) {
      upload.Ready(0);
      upload.Read();
      upload.Ack(0);
      upload.Reject(upload.Read(), grpc::StatusCode::INVALID_ARGUMENT,
                    "keyframes[0].stamp_ns: goes back");
      while (upload.Read() >= 0) {
      }
      return grpc::Status::OK;
    }
    upload.Ready(1);
    return upload.AcknowledgeEverything();
  }});
  Robot robot(server.address(), /*num_submaps=*/3);
  ASSERT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  robot.Push(1);  // a better one
  EXPECT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  EXPECT_THAT(robot.refused(),
              ElementsAre(std::pair(int64_t{1}, absl::StatusCode::kInvalidArgument)));
  EXPECT_EQ(robot.outbox().Level().submaps_acknowledged, 2);
}

// A broken server must not make the robot throw its data away.
TEST(SubmapUploader, DoesNotBelieveAnAcknowledgementOfWhatItHasNotSent) {
  ScriptedMappingServer server({[](int call, Upload& upload) {
    if (call == 0) {
      upload.Ack(1'000'000);
      upload.Ready(0);
      upload.Ack(1'000'000);
      while (upload.Read() >= 0) {
      }
      return grpc::Status::OK;
    }
    upload.Ready(0);
    return upload.AcknowledgeEverything();
  }});
  Robot robot(server.address(), /*num_submaps=*/3);
  ASSERT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  const std::vector<int64_t> received = server.Received();
  ASSERT_GE(received.size(), 3);
  EXPECT_THAT(std::vector<int64_t>(received.end() - 3, received.end()), ElementsAre(0, 1, 2));
}

// A server that lost what it had acknowledged: submaps are kept, and nothing goes out with a gap
// before it.
TEST(SubmapUploader, KeepsWhatWaitsWhenTheServerFellBehindWhatItAcknowledged) {
  ScriptedMappingServer server({[](int call, Upload& upload) {
    upload.Ready(call == 0 ? 3 : call < 4 ? 0 : 3);
    if (call == 0) return grpc::Status(grpc::StatusCode::UNAVAILABLE, "crash");
    return upload.AcknowledgeEverything();
  }});
  Robot robot(server.address(), /*num_submaps=*/5);
  ASSERT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  EXPECT_GE(server.Headers().size(), 5);
  for (const int64_t sequence : server.Received()) EXPECT_GE(sequence, 3);
  EXPECT_THAT(robot.gaps(), ElementsAre(3));
}

// One that closes old connections, or restarts within a moment.
TEST(SubmapUploader, AStreamThatWorkedIsBegunAnewAtOnceAndWithoutAWord) {
  ScriptedMappingServer server({[](int call, Upload& upload) {
    upload.Ready(call);
    if (call > 0) return upload.AcknowledgeEverything();
    upload.Ack(upload.Read());
    return grpc::Status::OK;
  }});
  Robot robot(server.address(), /*num_submaps=*/3);
  ASSERT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  EXPECT_THAT(server.Received(), ElementsAre(0, 1, 2));
  EXPECT_EQ(server.Headers().size(), 2u);
  for (const std::string& line : robot.log()) EXPECT_THAT(line, HasSubstr("upload ready"));
}

// The link lives and the server stands still: neither Ready nor an acknowledgement.
TEST(SubmapUploader, GivesUpAStreamOnWhichTheServerOwesAnAnswerForTooLong) {
  ScriptedMappingServer* running = nullptr;
  ScriptedMappingServer server({[&](int call, Upload& upload) {
    if (call == 0) return running->Park();
    upload.Ready(0);
    if (call > 1) return upload.AcknowledgeEverything();
    upload.Read();
    return running->Park();
  }});
  running = &server;
  Robot robot(server.address(), /*num_submaps=*/1, /*stall_timeout=*/absl::Milliseconds(100));
  EXPECT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  EXPECT_GE(server.Headers().size(), 3u);
}

// What is bounded is counted: the law of the bucket has its own test.
TEST(SubmapUploader, UnderABoundChunksAreSmallAndEveryByteIsPaidFor) {
  constexpr int64_t kRate = 200'000;
  std::vector<int64_t> chunks;
  ScriptedMappingServer server({[&](int, Upload& upload) {
    upload.Ready(0);
    upload.Ack(upload.Read());
    upload.Want({"a"});
    for (int64_t received = 0; received < 300'000; received += chunks.back()) {
      chunks.push_back(static_cast<int64_t>(upload.ReadFrame().blob().data().size()));
      if (chunks.back() == 0) return grpc::Status::OK;
    }
    upload.BlobResult("a", grpc::StatusCode::OK);
    return upload.AcknowledgeEverything();
  }});
  const TokenBucket::Clock::time_point start = TokenBucket::Clock::now();
  TokenBucket bucket(kRate);
  Robot robot(server.address(), /*num_submaps=*/0, absl::Minutes(5), &bucket);
  robot.Push(0, {Blob("a", 300'000)});
  ASSERT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  EXPECT_THAT(chunks, ElementsAre(200'000, 100'000));
  // 300 kB of 200 kB that were there, and of what came since.
  EXPECT_GT(bucket.ReadyAt(start), start);
}

TEST(SubmapUploader, SendsWhatIsWantedAndLetsItGoWhenItIsTaken) {
  ScriptedMappingServer server({[](int, Upload& upload) {
    upload.Ready(0);
    return upload.AcknowledgeEverything();
  }});
  Robot robot(server.address(), /*num_submaps=*/0);
  robot.Push(0, {Blob("a", 10), Blob("b", 1'200'000)});
  robot.Push(1, {Blob("c", 30)});
  ASSERT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  EXPECT_THAT(server.Blobs(),
              ElementsAre(std::string(10, 'a'), std::string(1'200'000, 'b'), std::string(30, 'c')));
  EXPECT_EQ(robot.drops(), 0);
}

// A cloud of sixteen chunks is wanted, of which only a few find room in HTTP/2's windows. A submap
// that was there before is sent before them, one that comes in between before those that are left.
TEST(SubmapUploader, ASubmapGoesBeforeTheChunksThatWait) {
  std::string frames;
  Robot* robot_pointer = nullptr;
  absl::Notification robot_is_there;
  ScriptedMappingServer server({[&](int, Upload& upload) {
    const auto read = [&] {
      const v1::UploadSubmapsRequest frame = upload.ReadFrame();
      frames += frame.has_submap() ? 'S' : 'c';
      if (frame.has_submap()) upload.Ack(frame.submap().sequence());
    };
    robot_is_there.WaitForNotification();
    upload.Ready(0, /*window_bytes=*/64 << 20);
    read();
    robot_pointer->Push(1);
    upload.Want({"a"});
    read();
    read();
    robot_pointer->Push(2);
    for (int i = 0; i < 16; ++i) read();
    upload.BlobResult("a", grpc::StatusCode::OK);
    return upload.AcknowledgeEverything();
  }});
  Robot robot(server.address(), /*num_submaps=*/0);
  robot_pointer = &robot;
  robot.Push(0, {Blob("a", 16 << 19)});
  robot_is_there.Notify();
  ASSERT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  ASSERT_EQ(frames.size(), 19u);
  EXPECT_EQ(frames.substr(0, 3), "SSc");
  EXPECT_LT(frames.rfind('S'), 18u) << frames;
}

TEST(SubmapUploader, ABlobCutInTheMiddleIsSentAgainWhenTheNextReadyWantsIt) {
  ScriptedMappingServer server({[](int call, Upload& upload) {
    if (call == 0) {
      upload.Ready(0);
      upload.Ack(upload.Read());
      upload.Want({"a", "b", "never heard of"});
      upload.ReadFrame();
      return grpc::Status(grpc::StatusCode::UNAVAILABLE, "cable cut");
    }
    upload.Ready(1);
    upload.Want({"a"});  // b came through another robot
    int64_t received = 0;
    while (received < 1'000'000) {
      const v1::UploadSubmapsRequest frame = upload.ReadFrame();
      EXPECT_EQ(frame.blob().offset(), received);
      received += static_cast<int64_t>(frame.blob().data().size());
    }
    upload.BlobResult("a", grpc::StatusCode::OK);
    upload.Want({});
    while (upload.Read() >= 0) {
    }
    return grpc::Status::OK;
  }});
  Robot robot(server.address(), /*num_submaps=*/0);
  robot.Push(0, {Blob("a", 1'000'000), Blob("b", 10)});
  EXPECT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  EXPECT_EQ(robot.outbox().Level().clouds_dropped, 0);
}

TEST(SubmapUploader, ARefusedBlobIsReportedAndTheStreamGoesOn) {
  ScriptedMappingServer server({[](int, Upload& upload) {
    upload.Ready(0);
    upload.Ack(upload.Read());
    upload.Want({"a"});
    upload.ReadFrame();
    upload.BlobResult("a", grpc::StatusCode::INVALID_ARGUMENT);
    return upload.AcknowledgeEverything();
  }});
  Robot robot(server.address(), /*num_submaps=*/0);
  robot.Push(0, {Blob("a", 10)});
  ASSERT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  robot.Push(1, {Blob("b", 10)});
  ASSERT_TRUE(robot.outbox().AwaitEmpty(kPatience));
  EXPECT_EQ(robot.outbox().Level().clouds_dropped, 1);
  EXPECT_EQ(robot.drops(), 1);
  EXPECT_EQ(server.Headers().size(), 1u);
}

TEST(SubmapUploader, StopsAtOnceWhateverTheServerDoes) {
  SilentSocket half_open;
  ScriptedMappingServer parked({});
  for (const std::string& address :
       {half_open.address(), parked.address(), std::string("127.0.0.1:1"),
        std::string("no-such-host.invalid:7077")}) {
    Robot robot(address, /*num_submaps=*/1);
    const absl::Time start = absl::Now();
    robot.Stop();
    EXPECT_LT(absl::Now() - start, absl::Seconds(1)) << address;
  }
}

}  // namespace
}  // namespace overtone
