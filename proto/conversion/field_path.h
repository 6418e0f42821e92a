// SPDX-License-Identifier: Apache-2.0
// Errors that name the field. An inner conversion says "orientation: why"; each outer one puts its
// own name before it, so that the sender reads "submap.keyframes[3].mission_tform_body.orientation:
// why".
#ifndef OVERTONE_PROTO_CONVERSION_FIELD_PATH_H_
#define OVERTONE_PROTO_CONVERSION_FIELD_PATH_H_

#include <utility>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"

namespace overtone {

inline absl::Status InvalidField(absl::string_view field, absl::string_view what) {
  return absl::InvalidArgumentError(absl::StrCat(field, ": ", what));
}

// Ok stays ok; else the same code with "field." before the message.
inline absl::Status AtField(absl::string_view field, const absl::Status& status) {
  if (status.ok()) return status;
  return absl::Status(status.code(), absl::StrCat(field, ".", status.message()));
}
inline absl::Status AtField(absl::string_view field, int index, const absl::Status& status) {
  return status.ok() ? status : AtField(absl::StrCat(field, "[", index, "]"), status);
}

template <typename T>
absl::StatusOr<T> AtField(absl::string_view field, absl::StatusOr<T> value) {
  if (value.ok()) return value;
  return AtField(field, value.status());
}
template <typename T>
absl::StatusOr<T> AtField(absl::string_view field, int index, absl::StatusOr<T> value) {
  if (value.ok()) return value;
  return AtField(field, index, value.status());
}

}  // namespace overtone

#endif  // OVERTONE_PROTO_CONVERSION_FIELD_PATH_H_
