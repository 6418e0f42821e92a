// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/blob_queue.h"

#include <algorithm>
#include <utility>

namespace overtone {
namespace {

int64_t Size(const WaitingBlob& blob) { return static_cast<int64_t>(blob.bytes->size()); }

}  // namespace

void BlobQueue::Push(WaitingBlob blob) {
  bytes_ += Size(blob);
  blobs_.push_back(std::move(blob));
}

void BlobQueue::PopFront() {
  bytes_ -= Size(blobs_.front());
  blobs_.pop_front();
}

SharedBytes BlobQueue::Find(const std::string& sha256) const {
  const auto it = std::find_if(blobs_.begin(), blobs_.end(),
                               [&](const WaitingBlob& blob) { return blob.sha256 == sha256; });
  return it == blobs_.end() ? nullptr : it->bytes;
}

int64_t BlobQueue::Remove(const std::string& sha256) {
  int64_t removed = 0;
  for (auto it = blobs_.begin(); it != blobs_.end();) {
    if (it->sha256 != sha256) {
      ++it;
      continue;
    }
    bytes_ -= Size(*it);
    it = blobs_.erase(it);
    ++removed;
  }
  return removed;
}

void BlobQueue::RemoveThrough(int64_t sequence) {
  while (!blobs_.empty() && blobs_.front().sequence <= sequence) PopFront();
}

void BlobQueue::RemoveFrom(int64_t sequence) {
  for (; !blobs_.empty() && blobs_.back().sequence >= sequence; blobs_.pop_back()) {
    bytes_ -= Size(blobs_.back());
  }
}

}  // namespace overtone
