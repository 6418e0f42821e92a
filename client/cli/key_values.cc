// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/cli/key_values.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "absl/strings/str_split.h"
#include "overtone/core/common/parse_number.h"

namespace overtone {
namespace {

absl::Status ParseOne(absl::string_view item,
                      const std::vector<std::pair<std::string, double*>>& targets) {
  const std::pair<absl::string_view, absl::string_view> parts =
      absl::StrSplit(item, absl::MaxSplits('=', 1));
  for (const auto& [key, target] : targets) {
    if (key != parts.first) continue;
    const absl::StatusOr<double> number = ParseFiniteDouble(parts.second);
    if (!number.ok()) {
      return absl::InvalidArgumentError(absl::StrCat(key, ": ", number.status().message()));
    }
    *target = *number;
    return absl::OkStatus();
  }
  const auto key = [](std::string* out, const auto& target) { out->append(target.first); };
  return absl::InvalidArgumentError(absl::StrCat(
      "\"", item, "\" is not KEY=NUMBER with KEY one of ", absl::StrJoin(targets, ", ", key)));
}

}  // namespace

absl::Status ParseKeyValues(absl::string_view text,
                            const std::vector<std::pair<std::string, double*>>& targets) {
  for (const absl::string_view item : absl::StrSplit(text, ',', absl::SkipEmpty())) {
    if (absl::Status status = ParseOne(item, targets); !status.ok()) return status;
  }
  return absl::OkStatus();
}

}  // namespace overtone
