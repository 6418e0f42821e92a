// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/loop_closure_uploader.h"

#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/client/internal/channel.h"
#include "overtone/tests/support/scripted_mapping_server.h"

namespace overtone {
namespace {

using testing::ElementsAre;

constexpr absl::Duration kPatience = absl::Seconds(20);

// A server that stores the batches (told apart by the map's name) for which `verdict(call)` is ok.
class Fixture {
 public:
  explicit Fixture(std::function<grpc::StatusCode(int call)> verdict)
      : server_({{}, {}, [this, verdict](int call, const v1::AddLoopClosuresRequest& request) {
                   const grpc::StatusCode code = verdict(call);
                   absl::MutexLock lock(&mutex_);
                   calls_.push_back(request.map());
                   return code == grpc::StatusCode::OK ? grpc::Status::OK
                                                       : grpc::Status(code, "because");
                 }}) {
    MappingClientOptions options;
    options.server = server_.address();
    stub_ = v1::MappingService::NewStub(CreateChannel(options));
    uploader_ = std::make_unique<LoopClosureUploader>(
        stub_.get(), Backoff(absl::Milliseconds(2), absl::Milliseconds(20), /*seed=*/1), &outbox_,
        &counters_, Logger(), [this](const absl::Status& reason) {
          absl::MutexLock lock(&mutex_);
          refused_.push_back(reason.code());
        });
  }

  void Push(const std::string& map) {
    v1::AddLoopClosuresRequest request;
    request.set_map(map);
    ASSERT_TRUE(
        outbox_.PushLoopClosures(std::make_shared<const std::string>(request.SerializeAsString()))
            .ok());
    uploader_->Notify();
  }

  bool AwaitEmpty() { return outbox_.AwaitEmpty(kPatience); }
  // Submaps aside.
  bool AwaitNoLoopClosures() {
    const absl::Time deadline = absl::Now() + kPatience;
    while (outbox_.FrontLoopClosures() != nullptr && absl::Now() < deadline) {
      std::this_thread::yield();
    }
    return outbox_.FrontLoopClosures() == nullptr;
  }
  SubmapOutbox& outbox() { return outbox_; }
  std::vector<std::string> calls() {
    absl::MutexLock lock(&mutex_);
    return calls_;
  }
  std::vector<absl::StatusCode> refused() {
    absl::MutexLock lock(&mutex_);
    return refused_;
  }

 private:
  absl::Mutex mutex_;
  std::vector<std::string> calls_ ABSL_GUARDED_BY(mutex_);
  std::vector<absl::StatusCode> refused_ ABSL_GUARDED_BY(mutex_);
  ScriptedMappingServer server_;
  SubmapOutbox outbox_{1 << 20};
  TrafficCounters counters_;
  std::unique_ptr<v1::MappingService::Stub> stub_;
  std::unique_ptr<LoopClosureUploader> uploader_;
};

TEST(LoopClosureUploader, SendsBatchesInOrder) {
  Fixture fixture([](int) { return grpc::StatusCode::OK; });
  for (const char* batch : {"a", "b", "c"}) fixture.Push(batch);
  ASSERT_TRUE(fixture.AwaitEmpty());
  EXPECT_THAT(fixture.calls(), ElementsAre("a", "b", "c"));
}

TEST(LoopClosureUploader, TriesAgainWhatMayGetBetter) {
  Fixture fixture([](int call) {
    constexpr grpc::StatusCode kCodes[] = {grpc::StatusCode::UNAVAILABLE, grpc::StatusCode::ABORTED,
                                           grpc::StatusCode::RESOURCE_EXHAUSTED,
                                           grpc::StatusCode::DEADLINE_EXCEEDED};
    return call < 4 ? kCodes[call] : grpc::StatusCode::OK;
  });
  fixture.Push("a");
  fixture.Push("b");
  ASSERT_TRUE(fixture.AwaitEmpty());
  EXPECT_THAT(fixture.calls(), ElementsAre("a", "a", "a", "a", "a", "b"));
  EXPECT_TRUE(fixture.refused().empty());
}

// A map comes into being with its first submap, which another thread sends.
TEST(LoopClosureUploader, ABatchThatOvertookTheFirstSubmapComesAgain) {
  Fixture fixture(
      [](int call) { return call < 2 ? grpc::StatusCode::NOT_FOUND : grpc::StatusCode::OK; });
  ASSERT_TRUE(fixture.outbox().PushSubmap({0, 0, std::make_shared<const std::string>()}, {}).ok());
  fixture.Push("a");
  ASSERT_TRUE(fixture.AwaitNoLoopClosures());
  EXPECT_THAT(fixture.calls(), ElementsAre("a", "a", "a"));
  EXPECT_TRUE(fixture.refused().empty());
}

TEST(LoopClosureUploader, WithoutSubmapsAMapThatIsNotThereIsAFinalRefusal) {
  Fixture fixture([](int) { return grpc::StatusCode::NOT_FOUND; });
  fixture.Push("a");
  ASSERT_TRUE(fixture.AwaitEmpty());
  EXPECT_THAT(fixture.calls(), ElementsAre("a"));
  EXPECT_THAT(fixture.refused(), ElementsAre(absl::StatusCode::kNotFound));
}

TEST(LoopClosureUploader, ReportsAFinalRefusalOnceAndGoesOn) {
  Fixture fixture([](int call) {
    return call == 0 ? grpc::StatusCode::INVALID_ARGUMENT : grpc::StatusCode::OK;
  });
  fixture.Push("a");
  fixture.Push("b");
  ASSERT_TRUE(fixture.AwaitEmpty());
  EXPECT_THAT(fixture.calls(), ElementsAre("a", "b"));
  EXPECT_THAT(fixture.refused(), ElementsAre(absl::StatusCode::kInvalidArgument));
}

TEST(LoopClosureUploader, StopsAtOnceWhateverTheServerDoes) {
  SilentSocket half_open;
  ScriptedMappingServer parked({});
  for (const std::string& address :
       {half_open.address(), parked.address(), std::string("127.0.0.1:1")}) {
    MappingClientOptions options;
    options.server = address;
    const auto stub = v1::MappingService::NewStub(CreateChannel(options));
    SubmapOutbox outbox(1000);
    ASSERT_TRUE(outbox.PushLoopClosures(std::make_shared<const std::string>()).ok());
    TrafficCounters counters;
    auto uploader = std::make_unique<LoopClosureUploader>(
        stub.get(), Backoff(absl::Seconds(60), absl::Seconds(60)), &outbox, &counters, Logger(),
        [](const absl::Status&) {});
    const absl::Time start = absl::Now();
    uploader.reset();
    EXPECT_LT(absl::Now() - start, absl::Seconds(1)) << address;
  }
}

}  // namespace
}  // namespace overtone
