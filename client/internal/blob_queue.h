// SPDX-License-Identifier: Apache-2.0
// The encoded clouds that wait for the server: part of the outbox.
#ifndef OVERTONE_CLIENT_INTERNAL_BLOB_QUEUE_H_
#define OVERTONE_CLIENT_INTERNAL_BLOB_QUEUE_H_

#include <cstdint>
#include <deque>
#include <functional>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "overtone/client/internal/outbox_item.h"

namespace overtone {

// By sequence. Two keyframes may have equal clouds: then there are two of that digest. What
// leaves the queue is returned. Not thread-safe.
class BlobQueue {
 public:
  int64_t bytes() const { return bytes_; }
  // To be marked as saved; nothing else.
  std::deque<OutboxItem>& items() { return items_; }
  const std::deque<OutboxItem>& items() const { return items_; }
  bool empty() const { return items_.empty(); }
  int64_t size() const { return static_cast<int64_t>(items_.size()); }

  // Its sequence is no smaller than the last one's.
  void Push(OutboxItem blob);
  OutboxItem PopFront();
  const OutboxItem* Find(const std::string& sha256) const;  // null: not there
  std::vector<OutboxItem> Remove(const std::string& sha256);
  std::vector<OutboxItem> RemoveThrough(int64_t sequence);
  std::vector<OutboxItem> RemoveFrom(int64_t sequence);
  // How many there were.
  int64_t RemoveIf(const std::function<bool(const OutboxItem&)>& condition);

 private:
  void Forget(const OutboxItem& blob);

  // What is asked for and answered is near the front; what is not there is not looked for.
  std::deque<OutboxItem> items_;
  absl::flat_hash_map<std::string, int64_t> count_;  // by digest
  int64_t bytes_ = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_BLOB_QUEUE_H_
