// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/submap_outbox.h"

#include <string>
#include <thread>

#include "gtest/gtest.h"

namespace overtone {
namespace {

SharedBytes Bytes(int size) { return std::make_shared<const std::string>(size, 'x'); }

WaitingSubmap SubmapOf(int64_t sequence, int size) {
  return {sequence, 10 * sequence, Bytes(size)};
}

WaitingBlob BlobOf(int64_t sequence, const std::string& sha256, int size) {
  return {sequence, sha256, Bytes(size)};
}

TEST(InMemoryOutbox, KeepsSubmapsInOrderUntilTheyAreAcknowledged) {
  InMemoryOutbox outbox(/*capacity_bytes=*/1000);
  for (int64_t sequence = 3; sequence < 8; ++sequence)
    ASSERT_TRUE(outbox.PushSubmap(SubmapOf(sequence, 10), {}).ok());

  EXPECT_EQ(outbox.FirstSubmapFrom(0)->sequence, 3);
  EXPECT_EQ(outbox.FirstSubmapFrom(5)->sequence, 5);
  EXPECT_FALSE(outbox.FirstSubmapFrom(8).has_value());

  outbox.RemoveSubmapsThrough(4);
  outbox.RemoveSubmapsThrough(4);
  EXPECT_EQ(outbox.Level().submaps_acknowledged, 2);
  EXPECT_EQ(outbox.FirstSubmapFrom(0)->sequence, 5);
  EXPECT_EQ(outbox.Level().submaps, 3);
  EXPECT_EQ(outbox.Level().bytes, 30);
}

TEST(InMemoryOutbox, RemovesARefusedSubmapWithAllThatFollow) {
  InMemoryOutbox outbox(1000);
  for (int64_t sequence = 0; sequence < 5; ++sequence)
    ASSERT_TRUE(outbox.PushSubmap(SubmapOf(sequence, 10), {}).ok());
  const std::vector<WaitingSubmap> removed = outbox.RemoveSubmapsFrom(2);
  ASSERT_EQ(removed.size(), 3);
  EXPECT_EQ(removed.front().sequence, 2);
  EXPECT_EQ(removed.front().first_index, 20);
  EXPECT_EQ(removed.back().sequence, 4);
  EXPECT_EQ(outbox.Level().submaps, 2);
  EXPECT_EQ(outbox.Level().submaps_acknowledged, 0);
  EXPECT_EQ(outbox.Level().bytes, 20);
  EXPECT_TRUE(outbox.PushSubmap(SubmapOf(2, 10), {}).ok());
  EXPECT_EQ(outbox.FirstSubmapFrom(2)->sequence, 2);
}

TEST(InMemoryOutbox, BothQueuesShareOneBoundAndAFullOneKeepsNothing) {
  InMemoryOutbox outbox(100);
  ASSERT_TRUE(outbox.PushSubmap(SubmapOf(0, 60), {}).ok());
  ASSERT_TRUE(outbox.PushLoopClosures(Bytes(40)).ok());
  EXPECT_EQ(outbox.PushSubmap(SubmapOf(1, 1), {}).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(outbox.PushLoopClosures(Bytes(1)).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(outbox.Level().bytes, 100);
  EXPECT_FALSE(outbox.FirstSubmapFrom(1).has_value());

  outbox.PopLoopClosures();
  EXPECT_TRUE(outbox.PushSubmap(SubmapOf(1, 40), {}).ok());
}

TEST(InMemoryOutbox, HandsOutLoopClosuresInOrderOfArrival) {
  InMemoryOutbox outbox(100);
  EXPECT_EQ(outbox.FrontLoopClosures(), nullptr);
  outbox.PopLoopClosures();  // nothing to pop: no harm
  ASSERT_TRUE(outbox.PushLoopClosures(Bytes(1)).ok());
  ASSERT_TRUE(outbox.PushLoopClosures(Bytes(2)).ok());
  EXPECT_EQ(outbox.FrontLoopClosures()->size(), 1);
  outbox.PopLoopClosures();
  EXPECT_EQ(outbox.FrontLoopClosures()->size(), 2);
  EXPECT_EQ(outbox.Level().loop_closure_batches, 1);
  EXPECT_EQ(outbox.Level().bytes, 2);
}

TEST(InMemoryOutbox, WhoWaitsForItToBeEmptyWakesWithTheLastRemoval) {
  InMemoryOutbox outbox(100);
  EXPECT_TRUE(outbox.AwaitEmpty(absl::ZeroDuration()));
  ASSERT_TRUE(outbox.PushSubmap(SubmapOf(0, 1), {}).ok());
  ASSERT_TRUE(outbox.PushLoopClosures(Bytes(1)).ok());
  EXPECT_FALSE(outbox.AwaitEmpty(absl::Milliseconds(10)));
  std::thread acknowledge([&] {
    outbox.RemoveSubmapsThrough(0);
    outbox.PopLoopClosures();
  });
  EXPECT_TRUE(outbox.AwaitEmpty(absl::Seconds(20)));
  acknowledge.join();
}

TEST(InMemoryOutbox, KeepsBlobsUntilTheServerHasOrWillNeverHaveThem) {
  InMemoryOutbox outbox(1000);
  ASSERT_TRUE(outbox.PushSubmap(SubmapOf(0, 10), {BlobOf(0, "a", 100), BlobOf(0, "b", 50)}).ok());
  ASSERT_TRUE(outbox.PushSubmap(SubmapOf(1, 10), {BlobOf(1, "a", 100), BlobOf(1, "c", 20)}).ok());
  outbox.RemoveSubmapsThrough(1);
  EXPECT_EQ(outbox.Level().blobs, 4);
  EXPECT_EQ(outbox.Level().bytes, 270);
  EXPECT_EQ(outbox.FindBlob("b")->size(), 50);
  EXPECT_EQ(outbox.FindBlob("z"), nullptr);
  outbox.RemoveBlob("a");  // both keyframes have the same cloud
  EXPECT_EQ(outbox.FindBlob("a"), nullptr);
  EXPECT_EQ(outbox.Level().bytes, 70);
  outbox.DropBlob("b");
  outbox.DropBlob("z");
  EXPECT_EQ(outbox.Level().clouds_dropped, 1);
  EXPECT_FALSE(outbox.AwaitEmpty(absl::ZeroDuration()));
  outbox.RemoveBlobsThrough(0);
  EXPECT_EQ(outbox.Level().blobs, 1);
  outbox.RemoveBlobsThrough(1);
  EXPECT_EQ(outbox.Level().bytes, 0);
  EXPECT_TRUE(outbox.AwaitEmpty(absl::ZeroDuration()));
}

TEST(InMemoryOutbox, AFullOneGivesUpTheOldestBlobsAndNeverASubmap) {
  InMemoryOutbox outbox(100);
  ASSERT_TRUE(outbox.PushSubmap(SubmapOf(0, 10), {BlobOf(0, "a", 30), BlobOf(0, "b", 30)}).ok());
  ASSERT_TRUE(outbox.PushSubmap(SubmapOf(1, 10), {BlobOf(1, "c", 30)}).ok());
  EXPECT_EQ(outbox.FindBlob("a"), nullptr);
  EXPECT_NE(outbox.FindBlob("b"), nullptr);
  EXPECT_EQ(outbox.Level().bytes, 80);
  EXPECT_EQ(outbox.Level().clouds_dropped, 1);
  // More than all clouds together leave room for: every one of them goes, and the new one too.
  ASSERT_TRUE(outbox.PushSubmap(SubmapOf(2, 70), {BlobOf(2, "d", 20)}).ok());
  EXPECT_EQ(outbox.Level().submaps, 3);
  EXPECT_EQ(outbox.Level().bytes, 90);
  EXPECT_EQ(outbox.Level().clouds_dropped, 4);
  ASSERT_TRUE(outbox.PushLoopClosures(Bytes(5)).ok());
  // What does not fit costs nothing else its place.
  outbox.RemoveSubmapsThrough(1);
  ASSERT_TRUE(outbox.PushSubmap(SubmapOf(3, 5), {BlobOf(3, "e", 10)}).ok());
  EXPECT_EQ(outbox.PushSubmap(SubmapOf(4, 50), {}).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_NE(outbox.FindBlob("e"), nullptr);
  ASSERT_TRUE(outbox.PushLoopClosures(Bytes(15)).ok());
  EXPECT_EQ(outbox.FindBlob("e"), nullptr);
}

TEST(InMemoryOutbox, ARefusedSubmapTakesItsBlobsAlong) {
  InMemoryOutbox outbox(1000);
  ASSERT_TRUE(outbox.PushSubmap(SubmapOf(0, 10), {BlobOf(0, "a", 30)}).ok());
  ASSERT_TRUE(outbox.PushSubmap(SubmapOf(1, 10), {BlobOf(1, "b", 30)}).ok());
  outbox.RemoveSubmapsFrom(1);
  EXPECT_NE(outbox.FindBlob("a"), nullptr);
  EXPECT_EQ(outbox.FindBlob("b"), nullptr);
  EXPECT_EQ(outbox.Level().bytes, 40);
  EXPECT_EQ(outbox.Level().clouds_dropped, 0);
}

}  // namespace
}  // namespace overtone
