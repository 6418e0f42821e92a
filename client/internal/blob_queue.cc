// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/blob_queue.h"

#include <algorithm>
#include <utility>

namespace overtone {

void BlobQueue::Push(OutboxItem blob) {
  bytes_ += blob.size;
  ++count_[blob.sha256];
  items_.push_back(std::move(blob));
}

void BlobQueue::Forget(const OutboxItem& blob) {
  bytes_ -= blob.size;
  const auto it = count_.find(blob.sha256);
  if (--it->second == 0) count_.erase(it);
}

OutboxItem BlobQueue::PopFront() {
  OutboxItem blob = std::move(items_.front());
  items_.pop_front();
  Forget(blob);
  return blob;
}

const OutboxItem* BlobQueue::Find(const std::string& sha256) const {
  if (!count_.contains(sha256)) return nullptr;
  return &*std::find_if(items_.begin(), items_.end(),
                        [&](const OutboxItem& blob) { return blob.sha256 == sha256; });
}

std::vector<OutboxItem> BlobQueue::Remove(const std::string& sha256) {
  std::vector<OutboxItem> removed;
  const auto count = count_.find(sha256);
  for (int64_t left = count == count_.end() ? 0 : count->second; left > 0; --left) {
    const auto it = std::find_if(items_.begin(), items_.end(),
                                 [&](const OutboxItem& blob) { return blob.sha256 == sha256; });
    Forget(*it);
    removed.push_back(std::move(*it));
    items_.erase(it);
  }
  return removed;
}

int64_t BlobQueue::RemoveIf(const std::function<bool(const OutboxItem&)>& condition) {
  const int64_t before = size();
  for (const OutboxItem& blob : items_) {
    if (condition(blob)) Forget(blob);
  }
  items_.erase(std::remove_if(items_.begin(), items_.end(), condition), items_.end());
  return before - size();
}

std::vector<OutboxItem> BlobQueue::RemoveThrough(int64_t sequence) {
  std::vector<OutboxItem> removed;
  while (!empty() && items_.front().sequence <= sequence) removed.push_back(PopFront());
  return removed;
}

std::vector<OutboxItem> BlobQueue::RemoveFrom(int64_t sequence) {
  std::vector<OutboxItem> removed;
  for (; !empty() && items_.back().sequence >= sequence; items_.pop_back()) {
    Forget(items_.back());
    removed.push_back(std::move(items_.back()));
  }
  return removed;
}

}  // namespace overtone
