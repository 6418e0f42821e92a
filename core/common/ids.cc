// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/common/ids.h"

#include <algorithm>

#include "absl/strings/escaping.h"
#include "absl/strings/str_cat.h"

namespace overtone {
namespace {

constexpr size_t kMaxIdLength = 63;

bool IsLowerOrDigit(char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'); }

bool IsIdCharacter(char c) { return IsLowerOrDigit(c) || c == '_' || c == '-'; }

}  // namespace

absl::Status ValidateId(absl::string_view id, absl::string_view field) {
  const bool valid = !id.empty() && id.size() <= kMaxIdLength && IsLowerOrDigit(id[0]) &&
                     std::all_of(id.begin(), id.end(), IsIdCharacter);
  if (valid) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat(field, ": '", absl::CEscape(id.substr(0, kMaxIdLength)),
                   "' is not an id; it must match [a-z0-9][a-z0-9_-]{0,62}"));
}

std::string ToString(const MissionId& id) { return absl::StrCat(id.robot, "/", id.mission); }

std::string ToString(const NodeId& id) { return absl::StrCat(ToString(id.mission), ":", id.index); }

}  // namespace overtone
