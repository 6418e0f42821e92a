// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/submap_sender.h"

#include <algorithm>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {

absl::Status SubmapSender::OnReady(const v1::UploadReady& ready) {
  if (ready_) return absl::InternalError("a second Ready on one stream");
  if (ready.next_sequence() < 0) {
    return absl::InternalError(
        absl::StrCat("the server expects submap ", ready.next_sequence(), ", which there is not"));
  }
  ready_ = true;
  next_ = ready.next_sequence();
  window_bytes_ = ready.window_bytes();
  acknowledged_through_ = next_ - 1;
  outbox_->RemoveSubmapsThrough(acknowledged_through_);
  return absl::OkStatus();
}

absl::Status SubmapSender::OnAck(const v1::UploadAck& ack) {
  const int64_t sequence = ack.durable_through_sequence();
  if (!ready_ || sequence >= next_) {
    return absl::InternalError(
        absl::StrCat("the server acknowledged submap ", sequence, ", which it was not sent"));
  }
  acknowledged_through_ = std::max(acknowledged_through_, sequence);
  outbox_->RemoveSubmapsThrough(sequence);
  while (!in_flight_.empty() && in_flight_.front().first <= sequence) {
    in_flight_bytes_ -= in_flight_.front().second;
    in_flight_.pop_front();
  }
  return absl::OkStatus();
}

absl::Status SubmapSender::CheckReject(const v1::UploadReject& reject) const {
  if (reject.code() != 0 && ready_ && reject.sequence() < next_) return absl::OkStatus();
  return absl::InternalError(
      absl::StrCat("the server refused submap ", reject.sequence(), ", which it was not sent"));
}

absl::StatusOr<std::optional<v1::UploadSubmapsRequest>> SubmapSender::Next(int64_t other_bytes) {
  if (!ready_) return std::nullopt;
  // A host that started over with the same mission hands over again what the server already holds.
  outbox_->RemoveSubmapsThrough(in_flight_.empty() ? next_ - 1 : in_flight_.front().first - 1);
  const std::optional<SubmapHead> submap = outbox_->FirstSubmapFrom(next_);
  if (!submap) return std::nullopt;
  if (submap->sequence != next_) {
    return absl::DataLossError(absl::StrCat("the server expects submap ", next_,
                                            ", but those before ", submap->sequence,
                                            " are gone; start a new mission"));
  }
  const bool fits = in_flight_bytes_ + other_bytes + submap->size <= window_bytes_;
  if (!fits && !in_flight_.empty()) return std::nullopt;  // the next Ack makes room

  ASSIGN_OR_RETURN(const SharedBytes bytes, outbox_->ReadSubmap(submap->sequence));
  v1::UploadSubmapsRequest request;
  if (!request.mutable_submap()->ParseFromString(*bytes)) {
    return absl::DataLossError(
        absl::StrCat("submap ", submap->sequence, " in the outbox is damaged"));
  }
  in_flight_.emplace_back(submap->sequence, submap->size);
  in_flight_bytes_ += submap->size;
  ++next_;
  return request;
}

}  // namespace overtone
