// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/submap_outbox.h"

#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "gtest/gtest.h"
#include "overtone/tests/support/temporary_directory.h"

namespace overtone {
namespace {

SharedBytes Bytes(int size) { return std::make_shared<const std::string>(size, 'x'); }

WaitingSubmap SubmapOf(int64_t sequence, int size) {
  return {sequence, 10 * sequence, Bytes(size)};
}

WaitingBlob BlobOf(int64_t sequence, const std::string& sha256, int size) {
  return {sequence, sha256, Bytes(size)};
}

// In memory and on disk; whatever is pushed on disk is written before anyone looks.
class SubmapOutboxTest : public ::testing::TestWithParam<bool> {
 protected:
  SubmapOutbox& Make(int64_t capacity_bytes) {
    if (!GetParam()) {
      outbox_ = std::make_unique<SubmapOutbox>(capacity_bytes);
    } else {
      auto outbox = SubmapOutbox::Open(capacity_bytes, directory_.File("a"), Logger());
      EXPECT_TRUE(outbox.ok()) << outbox.status();
      outbox_ = *std::move(outbox);
    }
    return *outbox_;
  }

  absl::Status Push(WaitingSubmap submap, std::vector<WaitingBlob> blobs) {
    const absl::Status status = outbox_->PushSubmap(std::move(submap), std::move(blobs));
    EXPECT_TRUE(outbox_->Flush().ok());
    return status;
  }
  absl::Status PushClosures(SharedBytes batch) {
    const absl::Status status = outbox_->PushLoopClosures(std::move(batch));
    EXPECT_TRUE(outbox_->Flush().ok());
    return status;
  }

 private:
  TemporaryDirectory directory_;
  std::unique_ptr<SubmapOutbox> outbox_;
};

INSTANTIATE_TEST_SUITE_P(InMemoryAndOnDisk, SubmapOutboxTest, ::testing::Bool(),
                         [](const auto& info) { return info.param ? "OnDisk" : "InMemory"; });

TEST_P(SubmapOutboxTest, KeepsSubmapsInOrderUntilTheyAreAcknowledged) {
  SubmapOutbox& outbox = Make(/*capacity_bytes=*/1000);
  for (int64_t sequence = 3; sequence < 8; ++sequence)
    ASSERT_TRUE(Push(SubmapOf(sequence, 10), {}).ok());

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

TEST_P(SubmapOutboxTest, RemovesARefusedSubmapWithAllThatFollow) {
  SubmapOutbox& outbox = Make(/*capacity_bytes=*/1000);
  for (int64_t sequence = 0; sequence < 5; ++sequence)
    ASSERT_TRUE(Push(SubmapOf(sequence, 10), {}).ok());
  const std::vector<SubmapHead> removed = outbox.RemoveSubmapsFrom(2);
  ASSERT_EQ(removed.size(), 3);
  EXPECT_EQ(removed.front().sequence, 2);
  EXPECT_EQ(removed.front().first_index, 20);
  EXPECT_EQ(removed.back().sequence, 4);
  EXPECT_EQ(outbox.Level().submaps, 2);
  EXPECT_EQ(outbox.Level().submaps_acknowledged, 0);
  EXPECT_EQ(outbox.Level().bytes, 20);
  EXPECT_TRUE(Push(SubmapOf(2, 10), {}).ok());
  EXPECT_EQ(outbox.FirstSubmapFrom(2)->sequence, 2);
}

TEST_P(SubmapOutboxTest, BothQueuesShareOneBoundAndAFullOneKeepsNothing) {
  SubmapOutbox& outbox = Make(/*capacity_bytes=*/100);
  ASSERT_TRUE(Push(SubmapOf(0, 60), {}).ok());
  ASSERT_TRUE(PushClosures(Bytes(40)).ok());
  EXPECT_EQ(Push(SubmapOf(1, 1), {}).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(PushClosures(Bytes(1)).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(outbox.Level().bytes, 100);
  EXPECT_FALSE(outbox.FirstSubmapFrom(1).has_value());

  outbox.PopLoopClosures();
  EXPECT_TRUE(Push(SubmapOf(1, 40), {}).ok());
}

TEST_P(SubmapOutboxTest, HandsOutLoopClosuresInOrderOfArrival) {
  SubmapOutbox& outbox = Make(/*capacity_bytes=*/100);
  EXPECT_EQ(outbox.FrontLoopClosures(), nullptr);
  outbox.PopLoopClosures();  // nothing to pop: no harm
  ASSERT_TRUE(PushClosures(Bytes(1)).ok());
  ASSERT_TRUE(PushClosures(Bytes(2)).ok());
  EXPECT_EQ(outbox.FrontLoopClosures()->size(), 1);
  outbox.PopLoopClosures();
  EXPECT_EQ(outbox.FrontLoopClosures()->size(), 2);
  EXPECT_EQ(outbox.Level().loop_closure_batches, 1);
  EXPECT_EQ(outbox.Level().bytes, 2);
}

TEST_P(SubmapOutboxTest, WhoWaitsForItToBeEmptyWakesWithTheLastRemoval) {
  SubmapOutbox& outbox = Make(/*capacity_bytes=*/100);
  EXPECT_TRUE(outbox.AwaitEmpty(absl::ZeroDuration()));
  ASSERT_TRUE(Push(SubmapOf(0, 1), {}).ok());
  ASSERT_TRUE(PushClosures(Bytes(1)).ok());
  EXPECT_FALSE(outbox.AwaitEmpty(absl::Milliseconds(10)));
  std::thread acknowledge([&] {
    outbox.RemoveSubmapsThrough(0);
    outbox.PopLoopClosures();
  });
  EXPECT_TRUE(outbox.AwaitEmpty(absl::Seconds(20)));
  acknowledge.join();
}

TEST_P(SubmapOutboxTest, KeepsBlobsUntilTheServerHasOrWillNeverHaveThem) {
  SubmapOutbox& outbox = Make(/*capacity_bytes=*/1000);
  ASSERT_TRUE(Push(SubmapOf(0, 10), {BlobOf(0, "a", 100), BlobOf(0, "b", 50)}).ok());
  ASSERT_TRUE(Push(SubmapOf(1, 10), {BlobOf(1, "a", 100), BlobOf(1, "c", 20)}).ok());
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

TEST_P(SubmapOutboxTest, AFullOneGivesUpTheOldestBlobsAndNeverASubmap) {
  SubmapOutbox& outbox = Make(/*capacity_bytes=*/100);
  ASSERT_TRUE(Push(SubmapOf(0, 10), {BlobOf(0, "a", 30), BlobOf(0, "b", 30)}).ok());
  ASSERT_TRUE(Push(SubmapOf(1, 10), {BlobOf(1, "c", 30)}).ok());
  EXPECT_EQ(outbox.FindBlob("a"), nullptr);
  EXPECT_NE(outbox.FindBlob("b"), nullptr);
  EXPECT_EQ(outbox.Level().bytes, 80);
  EXPECT_EQ(outbox.Level().clouds_dropped, 1);
  // More than all clouds together leave room for: every one of them goes, and the new one too.
  ASSERT_TRUE(Push(SubmapOf(2, 70), {BlobOf(2, "d", 20)}).ok());
  EXPECT_EQ(outbox.Level().submaps, 3);
  EXPECT_EQ(outbox.Level().bytes, 90);
  EXPECT_EQ(outbox.Level().clouds_dropped, 4);
  ASSERT_TRUE(PushClosures(Bytes(5)).ok());
  // What does not fit costs nothing else its place.
  outbox.RemoveSubmapsThrough(1);
  ASSERT_TRUE(Push(SubmapOf(3, 5), {BlobOf(3, "e", 10)}).ok());
  EXPECT_EQ(Push(SubmapOf(4, 50), {}).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_NE(outbox.FindBlob("e"), nullptr);
  ASSERT_TRUE(PushClosures(Bytes(15)).ok());
  EXPECT_EQ(outbox.FindBlob("e"), nullptr);
}

TEST_P(SubmapOutboxTest, ARefusedSubmapTakesItsBlobsAlong) {
  SubmapOutbox& outbox = Make(/*capacity_bytes=*/1000);
  ASSERT_TRUE(Push(SubmapOf(0, 10), {BlobOf(0, "a", 30)}).ok());
  ASSERT_TRUE(Push(SubmapOf(1, 10), {BlobOf(1, "b", 30)}).ok());
  outbox.RemoveSubmapsFrom(1);
  EXPECT_NE(outbox.FindBlob("a"), nullptr);
  EXPECT_EQ(outbox.FindBlob("b"), nullptr);
  EXPECT_EQ(outbox.Level().bytes, 40);
  EXPECT_EQ(outbox.Level().clouds_dropped, 0);
}

TEST_P(SubmapOutboxTest, KnowsWhereTheMissionGoesOn) {
  SubmapOutbox& outbox = Make(1000);
  EXPECT_EQ(outbox.Position().next_sequence, 0);
  ASSERT_TRUE(Push({0, 0, Bytes(1), /*num_keyframes=*/7, /*last_stamp_ns=*/70}, {}).ok());
  ASSERT_TRUE(Push({1, 7, Bytes(1), 3, 100}, {}).ok());
  ASSERT_TRUE(Push({2, 10, Bytes(1), 5, 150}, {}).ok());
  outbox.RemoveSubmapsThrough(0);
  EXPECT_EQ(outbox.Position().next_sequence, 3);
  EXPECT_EQ(outbox.Position().next_index, 15);
  EXPECT_EQ(outbox.Position().last_stamp_ns, 150);
  outbox.RemoveSubmapsFrom(1);
  EXPECT_EQ(outbox.Position().next_sequence, 1);
  EXPECT_EQ(outbox.Position().next_index, 7);
  EXPECT_EQ(outbox.LastSequence(), 0);
}

TEST_P(SubmapOutboxTest, WhatIsReservedCountsUntilItIsPushedOrReleased) {
  SubmapOutbox& outbox = Make(100);
  ASSERT_TRUE(outbox.Reserve(60).ok());
  EXPECT_EQ(outbox.Reserve(41).code(), absl::StatusCode::kResourceExhausted);
  EXPECT_EQ(outbox.Level().submaps, 1);
  EXPECT_FALSE(outbox.AwaitEmpty(absl::ZeroDuration()));
  ASSERT_TRUE(outbox.PushSubmap(SubmapOf(0, 50), {}, /*reserved=*/60).ok());
  EXPECT_EQ(outbox.Level().bytes, 50);
  ASSERT_TRUE(outbox.Reserve(50).ok());
  outbox.Release(50);
  EXPECT_EQ(outbox.Level().bytes, 50);
  EXPECT_EQ(outbox.Level().submaps, 1);
}

TEST_P(SubmapOutboxTest, ClosingWakesWhoWaits) {
  SubmapOutbox& outbox = Make(100);
  ASSERT_TRUE(Push(SubmapOf(0, 1), {}).ok());
  std::thread close([&] { outbox.Close(); });
  EXPECT_FALSE(outbox.AwaitEmpty(absl::Hours(1)));
  close.join();
}

}  // namespace
}  // namespace overtone
