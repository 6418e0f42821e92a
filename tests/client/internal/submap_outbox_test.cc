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

}  // namespace
}  // namespace overtone
