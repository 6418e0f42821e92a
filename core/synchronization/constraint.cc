// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/constraint.h"

#include "absl/strings/str_cat.h"

namespace overtone {

absl::string_view ToString(ConstraintKind kind) {
  switch (kind) {
    case ConstraintKind::kSmall:
      return "small";
    case ConstraintKind::kMid:
      return "mid";
    case ConstraintKind::kLarge:
      return "large";
    case ConstraintKind::kDegenerate:
      return "degenerate";
    case ConstraintKind::kChord:
      return "chord";
  }
  return "unknown";
}

std::string ConstraintId(ConstraintKind kind, int64_t from, int64_t to) {
  return absl::StrCat(ToString(kind), ":", from, "-", to);
}

}  // namespace overtone
