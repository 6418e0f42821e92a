// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/submap_store/operation_queue.h"

#include <utility>

namespace overtone {

void OperationQueue::Push(std::unique_ptr<StoreOperation> operation) {
  std::string lane = operation->lane();
  absl::MutexLock lock(&mutex_);
  lanes_[std::move(lane)].push_back(std::move(operation));
  ++unfinished_;
}

bool OperationQueue::Wait() const {
  absl::MutexLock lock(&mutex_, absl::Condition(this, &OperationQueue::HasNews));
  return !lanes_.empty();
}

OperationQueue::Lanes::iterator OperationQueue::NextLane(const OperationBatch& batch,
                                                         const BatchLimits& limits) {
  auto lane = lanes_.upper_bound(last_served_);
  for (size_t i = 0; i < lanes_.size(); ++i, ++lane) {
    if (lane == lanes_.end()) lane = lanes_.begin();
    const auto taken = batch.by_lane.find(lane->first);
    if (taken == batch.by_lane.end() || batch.by_lane.size() == 1 ||
        taken->second < limits.lane_beside_others) {
      return lane;
    }
  }
  return lanes_.end();
}

StoreOperation* OperationQueue::Extend(OperationBatch& batch, const BatchLimits& limits) {
  const bool begun = !batch.operations.empty();
  if (begun && (batch.bytes >= limits.bytes || batch.operations.back()->alone() ||
                batch.operations.size() >= static_cast<size_t>(limits.operations))) {
    return nullptr;
  }
  absl::MutexLock lock(&mutex_);
  const auto lane = NextLane(batch, limits);
  if (lane == lanes_.end() || (begun && lane->second.front()->alone())) return nullptr;
  batch.operations.push_back(std::move(lane->second.front()));
  batch.bytes += batch.operations.back()->bytes();
  ++batch.by_lane[lane->first];
  last_served_ = lane->first;
  lane->second.pop_front();
  if (lane->second.empty()) lanes_.erase(lane);
  return batch.operations.back().get();
}

void OperationQueue::Finished(size_t count) {
  absl::MutexLock lock(&mutex_);
  unfinished_ -= count;
}

int64_t OperationQueue::unfinished() const {
  absl::MutexLock lock(&mutex_);
  return static_cast<int64_t>(unfinished_);
}

void OperationQueue::AwaitFinished() const {
  absl::MutexLock lock(&mutex_, absl::Condition(this, &OperationQueue::AllFinished));
}

bool OperationQueue::empty() const {
  absl::MutexLock lock(&mutex_);
  return lanes_.empty();
}

void OperationQueue::Close() {
  absl::MutexLock lock(&mutex_);
  closed_ = true;
}

}  // namespace overtone
