// SPDX-License-Identifier: Apache-2.0
// The encoded clouds that wait for the server: part of the outbox.
#ifndef OVERTONE_CLIENT_INTERNAL_BLOB_QUEUE_H_
#define OVERTONE_CLIENT_INTERNAL_BLOB_QUEUE_H_

#include <cstdint>
#include <deque>
#include <memory>
#include <string>

namespace overtone {

using SharedBytes = std::shared_ptr<const std::string>;

struct WaitingBlob {
  int64_t sequence = 0;  // of its submap
  std::string sha256;
  SharedBytes bytes;
};

// By sequence. Two keyframes may have equal clouds: then there are two of that digest. Not
// thread-safe.
class BlobQueue {
 public:
  int64_t size() const { return static_cast<int64_t>(blobs_.size()); }
  bool empty() const { return blobs_.empty(); }
  int64_t bytes() const { return bytes_; }

  // Its sequence is no smaller than the last one's.
  void Push(WaitingBlob blob);
  void PopFront();
  SharedBytes Find(const std::string& sha256) const;  // null: not there
  // How many there were.
  int64_t Remove(const std::string& sha256);
  void RemoveThrough(int64_t sequence);
  void RemoveFrom(int64_t sequence);

 private:
  // What is asked for and answered is near the front.
  std::deque<WaitingBlob> blobs_;
  int64_t bytes_ = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_BLOB_QUEUE_H_
