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
using ::testing::IsEmpty;

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

std::vector<std::string> LanesOf(const OperationBatch& batch) {
  std::vector<std::string> lanes;
  for (const auto& operation : batch) lanes.push_back(operation->lane());
  return lanes;
}

TEST(OperationQueue, EveryLaneHasItsTurnAndTheNextBatchGoesOnBehindTheLast) {
  OperationQueue queue;
  for (int i = 0; i < 100; ++i) queue.Push(std::make_unique<Waiting>("noisy"));
  queue.Push(std::make_unique<Waiting>("anna"));
  queue.Push(std::make_unique<Waiting>("zoe"));
  EXPECT_THAT(LanesOf(queue.Take(/*max_bytes=*/20)), ElementsAre("anna", "noisy"));
  EXPECT_THAT(LanesOf(queue.Take(20)), ElementsAre("zoe", "noisy"));
  EXPECT_THAT(LanesOf(queue.Take(20)), ElementsAre("noisy", "noisy"));
}

TEST(OperationQueue, WhatGoesAloneIsABatchOfItsOwn) {
  OperationQueue queue;
  for (const char* lane : {"a", "c"}) queue.Push(std::make_unique<Waiting>(lane));
  queue.Push(std::make_unique<Waiting>("b", /*alone=*/true));
  EXPECT_THAT(LanesOf(queue.Take(1000)), ElementsAre("a"));
  EXPECT_THAT(LanesOf(queue.Take(1000)), ElementsAre("b"));
  EXPECT_THAT(LanesOf(queue.Take(1000)), ElementsAre("c"));
}

TEST(OperationQueue, AClosedQueueGivesWhatIsLeftThenNothing) {
  OperationQueue queue;
  queue.Push(std::make_unique<Waiting>("a"));
  queue.Close();
  EXPECT_THAT(LanesOf(queue.Take(1000)), ElementsAre("a"));
  EXPECT_THAT(LanesOf(queue.Take(1000)), IsEmpty());
}

}  // namespace
}  // namespace overtone
