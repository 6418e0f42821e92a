// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/blob_queue.h"

#include <algorithm>
#include <utility>

namespace overtone {

void BlobQueue::Push(OutboxItem blob) {
  bytes_ += blob.size;
  items_.push_back(std::move(blob));
}

OutboxItem BlobQueue::PopFront() {
  OutboxItem blob = std::move(items_.front());
  items_.pop_front();
  bytes_ -= blob.size;
  return blob;
}

const OutboxItem* BlobQueue::Find(const std::string& sha256) const {
  const auto it = std::find_if(items_.begin(), items_.end(),
                               [&](const OutboxItem& blob) { return blob.sha256 == sha256; });
  return it == items_.end() ? nullptr : &*it;
}

std::vector<OutboxItem> BlobQueue::Remove(const std::string& sha256) {
  std::vector<OutboxItem> removed;
  for (auto it = items_.begin(); it != items_.end();) {
    if (it->sha256 != sha256) {
      ++it;
      continue;
    }
    bytes_ -= it->size;
    removed.push_back(std::move(*it));
    it = items_.erase(it);
  }
  return removed;
}

int64_t BlobQueue::RemoveIf(const std::function<bool(const OutboxItem&)>& condition) {
  const int64_t before = size();
  items_.erase(std::remove_if(items_.begin(), items_.end(),
                              [&](const OutboxItem& blob) {
                                if (!condition(blob)) return false;
                                bytes_ -= blob.size;
                                return true;
                              }),
               items_.end());
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
    bytes_ -= items_.back().size;
    removed.push_back(std::move(items_.back()));
  }
  return removed;
}

}  // namespace overtone
