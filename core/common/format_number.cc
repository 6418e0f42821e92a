// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/common/format_number.h"

#include <array>
#include <charconv>
#include <cstdint>

#include "absl/strings/str_cat.h"

namespace overtone {

std::string FormatDouble(double value) {
  std::array<char, 32> text;  // the longest, -2.2250738585072014e-308, has 24 characters
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  return std::string(text.data(), end);
}

std::string FormatSeconds(Timestamp stamp) {
  constexpr uint64_t kNsPerSecond = 1000000000;
  // Unsigned, so that the most negative stamp has a magnitude, too.
  const uint64_t magnitude =
      stamp.ns < 0 ? -static_cast<uint64_t>(stamp.ns) : static_cast<uint64_t>(stamp.ns);
  return absl::StrCat(stamp.ns < 0 ? "-" : "", magnitude / kNsPerSecond, ".",
                      absl::Dec(magnitude % kNsPerSecond, absl::kZeroPad9));
}

}  // namespace overtone
