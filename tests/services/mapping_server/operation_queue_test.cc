// SPDX-License-Identifier: Apache-2.0
// Who is served when: one robot's backlog does not come before a neighbour's one submap.
#include "overtone/services/mapping_server/submap_store/operation_queue.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;

class Waiting : public StoreOperation {
 public:
  Waiting(std::string lane, bool alone = false) : lane_(std::move(lane)), alone_(alone) {}
  std::string lane() const override { return lane_; }
  int64_t bytes() const override { return 10; }
  bool alone() const override { return alone_; }
  absl::Status Write(BatchPlan&, StoreTables&) override { return absl::OkStatus(); }
  void Publish(StoreIndex&, SinkCalls&) override {}
  void Finish(const absl::Status&) override {}

 private:
  const std::string lane_;
  const bool alone_;
};

OperationQueue::BatchLimits Bytes(int64_t bytes) {
  OperationQueue::BatchLimits limits;
  limits.bytes = bytes;
  return limits;
}

// What the queue gives to a batch, which may hold some already.
std::vector<std::string> Fill(OperationQueue& queue, OperationBatch& batch,
                              const OperationQueue::BatchLimits& limits) {
  std::vector<std::string> lanes;
  while (const StoreOperation* const next = queue.Extend(batch, limits)) {
    lanes.push_back(next->lane());
  }
  return lanes;
}

std::vector<std::string> NextBatch(OperationQueue& queue, int64_t bytes = 1000) {
  OperationBatch batch;
  return Fill(queue, batch, Bytes(bytes));
}

void Push(OperationQueue& queue, const std::string& lane, int operations = 1) {
  for (int i = 0; i < operations; ++i) queue.Push(std::make_unique<Waiting>(lane));
}

TEST(OperationQueue, EveryLaneHasItsTurnAndTheNextBatchGoesOnBehindTheLast) {
  OperationQueue queue;
  Push(queue, "noisy", 100);
  Push(queue, "anna");
  Push(queue, "zoe");
  EXPECT_THAT(NextBatch(queue, /*bytes=*/20), ElementsAre("anna", "noisy"));
  EXPECT_THAT(NextBatch(queue, 20), ElementsAre("zoe", "noisy"));
  EXPECT_THAT(NextBatch(queue, 20), ElementsAre("noisy", "noisy"));
}

TEST(OperationQueue, WhoComesWhileABacklogIsWrittenHasAPlaceAndTheBacklogThenEndsTheBatch) {
  OperationQueue queue;
  OperationQueue::BatchLimits limits;
  limits.lane_beside_others = 3;
  Push(queue, "noisy", 100);
  OperationBatch batch;
  for (int i = 0; i < 10; ++i) ASSERT_EQ(queue.Extend(batch, limits)->lane(), "noisy");
  Push(queue, "anna", 2);
  EXPECT_THAT(Fill(queue, batch, limits), ElementsAre("anna", "anna"));
  // Beside another from the start: its share, and no more.
  Push(queue, "anna");
  batch = OperationBatch();
  EXPECT_THAT(Fill(queue, batch, limits), ElementsAre("noisy", "anna", "noisy", "noisy"));
}

TEST(OperationQueue, ABatchHasAnEndWhoeverGoesOnPushing) {
  OperationQueue queue;
  OperationQueue::BatchLimits limits;
  limits.operations = 5;
  OperationBatch batch;
  int taken = 0;
  do Push(queue, "a");
  while (queue.Extend(batch, limits) != nullptr && ++taken < 100);
  EXPECT_EQ(taken, 5);
}

TEST(OperationQueue, WhatGoesAloneIsABatchOfItsOwn) {
  OperationQueue queue;
  for (const char* lane : {"a", "c"}) Push(queue, lane);
  queue.Push(std::make_unique<Waiting>("b", /*alone=*/true));
  EXPECT_THAT(NextBatch(queue), ElementsAre("a"));
  EXPECT_THAT(NextBatch(queue), ElementsAre("b"));
  EXPECT_THAT(NextBatch(queue), ElementsAre("c"));
}

TEST(OperationQueue, AClosedQueueGivesWhatIsLeftThenNothing) {
  OperationQueue queue;
  Push(queue, "a");
  queue.Close();
  EXPECT_TRUE(queue.Wait());
  EXPECT_THAT(NextBatch(queue), ElementsAre("a"));
  EXPECT_FALSE(queue.Wait());
}

}  // namespace
}  // namespace overtone
