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

std::map<std::string, std::deque<std::unique_ptr<StoreOperation>>>::iterator
OperationQueue::NextLane() {
  const auto next = lanes_.upper_bound(last_served_);
  return next == lanes_.end() ? lanes_.begin() : next;
}

OperationBatch OperationQueue::Take(int64_t max_bytes) {
  absl::MutexLock lock(&mutex_, absl::Condition(this, &OperationQueue::HasNews));
  OperationBatch batch;
  for (int64_t bytes = 0; bytes < max_bytes && !lanes_.empty();) {
    const auto lane = NextLane();
    const bool alone = lane->second.front()->alone();
    if (alone && !batch.empty()) break;
    batch.push_back(std::move(lane->second.front()));
    lane->second.pop_front();
    bytes += batch.back()->bytes();
    last_served_ = lane->first;
    if (lane->second.empty()) lanes_.erase(lane);
    if (alone) break;
  }
  return batch;
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
