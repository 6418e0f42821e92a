// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/submap_sequence.h"

#include "absl/strings/str_cat.h"

namespace overtone {

absl::Status SubmapSequence::Check(const Submap& submap) const {
  if (submap.sequence != sequence_) {
    return absl::OutOfRangeError(
        absl::StrCat("sequence: expected ", sequence_, ", got ", submap.sequence));
  }
  if (submap.first_index != first_index_) {
    return absl::OutOfRangeError(
        absl::StrCat("first_index: expected ", first_index_, ", got ", submap.first_index));
  }
  if (submap.keyframes.front().stamp <= last_stamp_) {
    return absl::InvalidArgumentError(
        absl::StrCat("keyframes[0].stamp_ns: ", submap.keyframes.front().stamp.ns,
                     " is not after the previous submap's ", last_stamp_.ns));
  }
  return absl::OkStatus();
}

void SubmapSequence::Advance(const Submap& submap) {
  ++sequence_;
  first_index_ += static_cast<int64_t>(submap.keyframes.size());
  last_stamp_ = submap.keyframes.back().stamp;
}

void SubmapSequence::MoveTo(const OutboxPosition& position) {
  sequence_ = position.next_sequence;
  first_index_ = position.next_index;
  last_stamp_ = Timestamp{position.last_stamp_ns};
}

}  // namespace overtone
