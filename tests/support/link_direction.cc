// SPDX-License-Identifier: Apache-2.0
#include "overtone/tests/support/link_direction.h"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>

namespace overtone {
namespace {

constexpr int64_t kSegmentBytes = 1448;  // of Ethernet
// In flight at once: what congestion control comes down to when segments get lost, and many else.
constexpr int64_t kLossySegments = 4, kSegments = 16;
// Linux's least retransmission timeout; it doubles with every further loss.
constexpr absl::Duration kRetransmission = absl::Milliseconds(200);
constexpr int kMaxRetransmissions = 5;

// How much later the last of so many segments arrives.
absl::Duration RetransmissionDelay(int64_t segments, double loss, std::mt19937_64* random) {
  std::bernoulli_distribution lost(loss);
  absl::Duration longest;
  for (int64_t i = 0; i < segments; ++i) {
    int times = 0;
    while (times < kMaxRetransmissions && lost(*random)) ++times;
    longest = std::max(longest, kRetransmission * ((1 << times) - 1));
  }
  return longest;
}

}  // namespace

void LinkDirection::Read(const LinkConditions& conditions, absl::Time now, absl::Time* free_at,
                         std::mt19937_64* random) {
  char buffer[kSegments * kSegmentBytes];
  const int64_t most = (conditions.loss > 0 ? kLossySegments : kSegments) * kSegmentBytes;
  const ssize_t size = recv(from_, buffer, most, MSG_DONTWAIT);
  if (size < 0 && (errno == EAGAIN || errno == EINTR)) return;
  closed_ = size <= 0;
  if (closed_) return;
  absl::Time sent = std::max(now, *free_at);
  if (conditions.bytes_per_second > 0) {
    sent += absl::Seconds(static_cast<double>(size) / conditions.bytes_per_second);
  }
  if (conditions.loss > 0) {
    const int64_t segments = (size + kSegmentBytes - 1) / kSegmentBytes;
    sent += RetransmissionDelay(segments, conditions.loss, random);
  }
  *free_at = sent;
  waiting_.push_back({sent + conditions.latency, std::string(buffer, size)});
  waiting_bytes_ += size;
}

int64_t LinkDirection::Write(absl::Time now, int64_t limit) {
  int64_t total = 0;
  while (WantsToWrite(now) && total < limit) {
    Chunk& chunk = waiting_.front();
    const size_t size = std::min<size_t>(chunk.bytes.size() - chunk.written, limit - total);
    const ssize_t sent =
        send(to_, chunk.bytes.data() + chunk.written, size, MSG_NOSIGNAL | MSG_DONTWAIT);
    if (sent < 0 && (errno == EAGAIN || errno == EINTR)) break;
    if (sent <= 0) return -1;
    total += sent;
    chunk.written += sent;
    if (chunk.written == chunk.bytes.size()) waiting_.pop_front();
  }
  waiting_bytes_ -= total;
  return total;
}

}  // namespace overtone
