// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CLIENT_INTERNAL_SUBMAP_SENDER_H_
#define OVERTONE_CLIENT_INTERNAL_SUBMAP_SENDER_H_

#include <cstdint>
#include <deque>
#include <optional>
#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/client/internal/submap_outbox.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone {

// Where one upload stream stands with its submaps. An error says that the stream must end: the
// server broke the protocol, or holds another history than we do. Not thread-safe.
class SubmapSender {
 public:
  // `outbox` outlives the sender.
  explicit SubmapSender(SubmapOutbox* outbox) : outbox_(outbox) {}

  absl::Status OnReady(const v1::UploadReady& ready);
  absl::Status OnAck(const v1::UploadAck& ack);
  // Ok: it is about a submap that was sent.
  absl::Status CheckReject(const v1::UploadReject& reject) const;

  // The next submap that may go out; none: nothing waits, or the window, in which other_bytes are
  // under way too, is full. DataLoss: the server expects one that is not there any more.
  absl::StatusOr<std::optional<v1::UploadSubmapsRequest>> Next(int64_t other_bytes);

  bool ready() const { return ready_; }
  int64_t acknowledged_through() const { return acknowledged_through_; }
  int64_t bytes_in_flight() const { return in_flight_bytes_; }
  int64_t window_bytes() const { return window_bytes_; }

 private:
  SubmapOutbox* const outbox_;
  bool ready_ = false;
  int64_t next_ = 0;  // sequences [first unacknowledged, next_) are in flight
  int64_t window_bytes_ = 0;
  int64_t acknowledged_through_ = -1;
  std::deque<std::pair<int64_t, int64_t>> in_flight_;  // sequence, bytes
  int64_t in_flight_bytes_ = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_SUBMAP_SENDER_H_
