// SPDX-License-Identifier: Apache-2.0
// The encoded clouds that wait for the server: part of the outbox.
#ifndef OVERTONE_CLIENT_INTERNAL_BLOB_QUEUE_H_
#define OVERTONE_CLIENT_INTERNAL_BLOB_QUEUE_H_

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "absl/container/flat_hash_map.h"
#include "overtone/client/internal/outbox_item.h"

namespace overtone {

// By id, and so by sequence. Two keyframes may have equal clouds: then there are two of that
// digest. What leaves the queue is returned. No method but those that remove many takes more than
// logarithmic time: a robot may collect a hundred thousand. Not thread-safe.
class BlobQueue {
 public:
  using Items = std::map<int64_t, OutboxItem>;

  int64_t bytes() const { return bytes_; }
  const Items& items() const { return items_; }
  bool empty() const { return items_.empty(); }
  int64_t size() const { return static_cast<int64_t>(items_.size()); }

  // Its id is larger and its sequence no smaller than the last one's.
  void Push(OutboxItem blob);
  OutboxItem PopFront() { return Take(items_.begin()); }
  // It is in the file now. False: it is not there any more.
  bool MarkSaved(int64_t id);
  const OutboxItem* Find(const std::string& sha256) const;  // null: not there
  std::vector<OutboxItem> Remove(const std::string& sha256);
  std::vector<OutboxItem> RemoveThrough(int64_t sequence);
  std::vector<OutboxItem> RemoveFrom(int64_t sequence);
  std::vector<OutboxItem> RemoveIf(const std::function<bool(const OutboxItem&)>& condition);

 private:
  OutboxItem Take(Items::iterator it);

  Items items_;
  absl::flat_hash_map<std::string, std::vector<int64_t>> ids_;  // by digest, increasing
  int64_t bytes_ = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_BLOB_QUEUE_H_
