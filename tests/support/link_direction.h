// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_TESTS_SUPPORT_LINK_DIRECTION_H_
#define OVERTONE_TESTS_SUPPORT_LINK_DIRECTION_H_

#include <cstdint>
#include <deque>
#include <random>
#include <string>

#include "absl/time/time.h"
#include "overtone/tests/support/faulty_link.h"

namespace overtone {

// One way of one connection of a FaultyLink: what was read from one socket and when it is due at
// the other. Used by one thread.
class LinkDirection {
 public:
  LinkDirection(int from, int to) : from_(from), to_(to) {}

  // There is room for more on its way.
  bool WantsToRead(const LinkConditions& conditions) const {
    return !closed_ && waiting_bytes_ < (conditions.bytes_per_second > 0 ? kRadioBytes : kTcpBytes);
  }
  // Something is due at `now`, or the other socket must take more first.
  bool WantsToWrite(absl::Time now) const { return !waiting_.empty() && waiting_[0].due <= now; }
  absl::Time NextDue() const { return waiting_.empty() ? absl::InfiniteFuture() : waiting_[0].due; }
  // The sender has closed, and all it sent is delivered.
  bool Finished() const { return closed_ && waiting_.empty(); }

  // Reads what there is, at most a few segments. `free_at`: when the link can take the next byte.
  void Read(const LinkConditions& conditions, absl::Time now, absl::Time* free_at,
            std::mt19937_64* random);
  // Writes what is due, at most `limit` bytes. -1: the other end is gone.
  int64_t Write(absl::Time now, int64_t limit);

 private:
  // Under way at most: about what TCP has, and what a slow radio queues.
  static constexpr int64_t kTcpBytes = 1 << 18;
  static constexpr int64_t kRadioBytes = 1 << 14;

  struct Chunk {
    absl::Time due;
    std::string bytes;
    size_t written = 0;
  };

  int from_;
  int to_;
  bool closed_ = false;
  int64_t waiting_bytes_ = 0;
  std::deque<Chunk> waiting_;
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_LINK_DIRECTION_H_
