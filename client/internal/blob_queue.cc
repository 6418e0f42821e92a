// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/blob_queue.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace overtone {

void BlobQueue::Push(OutboxItem blob) {
  bytes_ += blob.size;
  ids_[blob.sha256].push_back(blob.id);
  const int64_t id = blob.id;
  items_.emplace_hint(items_.end(), id, std::move(blob));
}

OutboxItem BlobQueue::Take(Items::iterator it) {
  OutboxItem blob = std::move(it->second);
  items_.erase(it);
  bytes_ -= blob.size;
  const auto ids = ids_.find(blob.sha256);
  ids->second.erase(std::find(ids->second.begin(), ids->second.end(), blob.id));
  if (ids->second.empty()) ids_.erase(ids);
  return blob;
}

bool BlobQueue::MarkSaved(int64_t id) {
  const auto it = items_.find(id);
  if (it == items_.end()) return false;
  it->second.saved = true;
  it->second.bytes = nullptr;
  return true;
}

const OutboxItem* BlobQueue::Find(const std::string& sha256) const {
  const auto ids = ids_.find(sha256);
  return ids == ids_.end() ? nullptr : &items_.at(ids->second.front());
}

std::vector<OutboxItem> BlobQueue::Remove(const std::string& sha256) {
  std::vector<OutboxItem> removed;
  while (const OutboxItem* blob = Find(sha256)) removed.push_back(Take(items_.find(blob->id)));
  return removed;
}

std::vector<OutboxItem> BlobQueue::RemoveThrough(int64_t sequence) {
  std::vector<OutboxItem> removed;
  while (!empty() && items_.begin()->second.sequence <= sequence) removed.push_back(PopFront());
  return removed;
}

std::vector<OutboxItem> BlobQueue::RemoveFrom(int64_t sequence) {
  std::vector<OutboxItem> removed;
  while (!empty() && items_.rbegin()->second.sequence >= sequence) {
    removed.push_back(Take(std::prev(items_.end())));
  }
  return removed;
}

std::vector<OutboxItem> BlobQueue::RemoveIf(
    const std::function<bool(const OutboxItem&)>& condition) {
  std::vector<OutboxItem> removed;
  for (auto it = items_.begin(); it != items_.end();) {
    const auto next = std::next(it);
    if (condition(it->second)) removed.push_back(Take(it));
    it = next;
  }
  return removed;
}

}  // namespace overtone
