// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/graph_publisher.h"

#include <memory>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "gmock/gmock.h"
#include "grpcpp/impl/codegen/proto_utils.h"
#include "gtest/gtest.h"
#include "overtone/tests/proto/conversion_fixture.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone {
namespace {

using testing::MakeSubmap;

constexpr uint64_t kEpoch = 4;

// A map of one mission with `revision` submaps of ten keyframes.
std::shared_ptr<const MapSnapshot> Snapshot(uint64_t revision) {
  auto snapshot = std::make_shared<MapSnapshot>();
  snapshot->revision = revision;
  snapshot->map_epoch = kEpoch;
  SnapshotMission mission;
  mission.id = {"anna", "run1"};
  mission.anchored = true;
  mission.keyframes = MakeSubmap(0, 0, static_cast<int>(10 * revision)).keyframes;
  for (const Keyframe& keyframe : mission.keyframes) {
    mission.map_from_body.push_back(keyframe.mission_from_body);
  }
  for (uint64_t i = 0; i < revision; ++i) mission.submap_starts.push_back(10 * i);
  snapshot->missions.push_back(mission);
  return snapshot;
}

// Takes frames, and never says Ready by itself.
class FakeReader : public GraphReader {
 public:
  void Send(const grpc::ByteBuffer& frame, uint64_t /*revision*/) override {
    absl::MutexLock lock(&mutex_);
    frames_.push_back(frame);
  }
  void End(const absl::Status& status) override {
    absl::MutexLock lock(&mutex_);
    end_ = status;
    ended_ = true;
  }

  // Waits for frame `i`.
  v1::WatchGraphResponse Frame(size_t i) {
    grpc::ByteBuffer bytes = Bytes(i);
    v1::WatchGraphResponse response;
    EXPECT_TRUE(
        grpc::SerializationTraits<v1::WatchGraphResponse>::Deserialize(&bytes, &response).ok());
    return response;
  }
  grpc::ByteBuffer Bytes(size_t i) {
    absl::MutexLock lock(&mutex_);
    const auto there = [this, i]()
                           ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) { return frames_.size() > i; };
    EXPECT_TRUE(mutex_.AwaitWithTimeout(absl::Condition(&there), absl::Seconds(20)));
    return frames_.size() > i ? frames_[i] : grpc::ByteBuffer();
  }
  size_t NumFrames() {
    absl::MutexLock lock(&mutex_);
    return frames_.size();
  }
  absl::Status End() {
    absl::MutexLock lock(&mutex_);
    mutex_.Await(absl::Condition(&ended_));
    return end_;
  }

 private:
  absl::Mutex mutex_;
  std::vector<grpc::ByteBuffer> frames_ ABSL_GUARDED_BY(mutex_);
  bool ended_ ABSL_GUARDED_BY(mutex_) = false;
  absl::Status end_ ABSL_GUARDED_BY(mutex_);
};

class GraphPublisherTest : public ::testing::Test {
 protected:
  static ServerOptions Options() {
    ServerOptions options;
    options.publisher.heartbeat_s = 3600;
    options.publisher.history = 3;
    options.graph.min_distance_m = 0;
    options.graph.min_rotation_rad = 0;
    return options;
  }
  std::shared_ptr<FakeReader> Subscribe() {
    auto reader = std::make_shared<FakeReader>();
    Subscription subscription;
    subscription.query.max_nodes = 1000;
    publisher_.Subscribe(reader, subscription);
    return reader;
  }
  // Publishes and waits until the publisher has worked it off.
  void Publish(uint64_t revision) {
    publisher_.Publish(Snapshot(revision));
    absl::Mutex mutex;
    bool done = false;
    publisher_.GetNewest({1000, false, ""}, v1::GRAPH_ENCODING_COMPACT,
                         [&](const absl::StatusOr<v1::Graph>& graph) {
                           absl::MutexLock lock(&mutex);
                           EXPECT_EQ(graph->revision(), revision);
                           done = true;
                         });
    absl::MutexLock lock(&mutex);
    mutex.Await(absl::Condition(&done));
  }

  GraphPublisher publisher_{"mine", kEpoch, Options()};
};

TEST_F(GraphPublisherTest, AReaderThatIsNotReadySkipsToTheNewestRevision) {
  Publish(1);
  const auto reader = Subscribe();
  EXPECT_TRUE(reader->Frame(0).has_snapshot());
  Publish(2);
  Publish(3);
  EXPECT_EQ(reader->NumFrames(), 1u);
  publisher_.Ready(reader.get());
  const v1::WatchGraphResponse frame = reader->Frame(1);
  ASSERT_TRUE(frame.has_delta());
  EXPECT_EQ(frame.delta().base_revision(), 1u);
  EXPECT_EQ(frame.delta().changes().revision(), 3u);
  publisher_.Ready(reader.get());
  Publish(4);
  EXPECT_EQ(reader->Frame(2).delta().base_revision(), 3u);
}

TEST_F(GraphPublisherTest, AReaderBehindTheHistoryGetsASnapshot) {
  Publish(1);
  const auto reader = Subscribe();
  reader->Frame(0);
  for (uint64_t revision = 2; revision <= 5; ++revision) Publish(revision);
  publisher_.Ready(reader.get());
  EXPECT_EQ(reader->Frame(1).snapshot().revision(), 5u);
}

TEST_F(GraphPublisherTest, ReadersThatStandAtTheSameRevisionShareTheBytes) {
  Publish(1);
  const auto first = Subscribe();
  const auto second = Subscribe();
  std::vector<grpc::Slice> a;
  std::vector<grpc::Slice> b;
  ASSERT_TRUE(first->Bytes(0).Dump(&a).ok());
  ASSERT_TRUE(second->Bytes(0).Dump(&b).ok());
  ASSERT_FALSE(a.empty());
  EXPECT_EQ(a[0].begin(), b[0].begin());
}

TEST_F(GraphPublisherTest, AnUnsubscribedReaderHearsNothingMore) {
  Publish(1);
  const auto reader = Subscribe();
  reader->Frame(0);
  publisher_.Ready(reader.get());
  publisher_.Unsubscribe(reader.get());
  Publish(2);
  EXPECT_EQ(reader->NumFrames(), 1u);
}

TEST_F(GraphPublisherTest, StopEndsEveryReaderAndLateOnes) {
  const auto reader = Subscribe();
  publisher_.Stop();
  EXPECT_EQ(reader->End().code(), absl::StatusCode::kUnavailable);
  EXPECT_EQ(Subscribe()->End().code(), absl::StatusCode::kUnavailable);
}

}  // namespace
}  // namespace overtone
