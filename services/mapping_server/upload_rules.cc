// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/upload_rules.h"

#include "absl/strings/str_cat.h"
#include "overtone/proto/conversion/field_path.h"

namespace overtone {

absl::Status CheckContinues(const UploadState& state, const Submap& submap) {
  if (submap.sequence != state.next_sequence) {
    return absl::OutOfRangeError(
        absl::StrCat("sequence: ", submap.sequence, ", expected ", state.next_sequence));
  }
  if (submap.first_index != state.next_index) {
    return InvalidField("first_index",
                        absl::StrCat(submap.first_index, ", expected ", state.next_index));
  }
  const Timestamp first_stamp = submap.keyframes.front().stamp;
  if (state.next_index > 0 && first_stamp <= state.last_stamp) {
    return InvalidField(
        "keyframes[0].stamp_ns",
        absl::StrCat(first_stamp.ns, " is not after the mission's last, ", state.last_stamp.ns));
  }
  return absl::OkStatus();
}

}  // namespace overtone
