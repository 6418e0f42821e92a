// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/common/parse_number.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/escaping.h"
#include "absl/strings/numbers.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

constexpr int kMaxQuoted = 40;
// An exponent beyond this is nonsense in any stamp; the bound keeps the sums below inside an int.
constexpr int kMaxExponent = 10000;

absl::Status NotA(absl::string_view kind, absl::string_view text) {
  return absl::InvalidArgumentError(
      absl::StrCat("'", absl::CEscape(text.substr(0, kMaxQuoted)), "' is not ", kind));
}

// A decimal number taken apart: sign * 0.d1 d2 d3 ... * 10^point, d1 != 0 unless there are no
// digits (zero).
struct Decimal {
  bool negative = false;
  std::string digits;
  int point = 0;
};

bool ConsumeSign(absl::string_view& text) {
  const bool negative = !text.empty() && text[0] == '-';
  if (negative || (!text.empty() && text[0] == '+')) text.remove_prefix(1);
  return negative;
}

absl::string_view ConsumeDigits(absl::string_view& text) {
  const auto end = std::find_if_not(text.begin(), text.end(), absl::ascii_isdigit);
  const absl::string_view digits = text.substr(0, end - text.begin());
  text.remove_prefix(digits.size());
  return digits;
}

// [exponent] = "" or e[+-]digits. False when it is something else.
bool ParseExponent(absl::string_view text, int* exponent) {
  *exponent = 0;
  if (text.empty()) return true;
  if (absl::ascii_tolower(text[0]) != 'e') return false;
  text.remove_prefix(1);
  const bool negative = ConsumeSign(text);
  const absl::string_view digits = ConsumeDigits(text);
  if (!text.empty() || !absl::SimpleAtoi(digits, exponent) || *exponent > kMaxExponent)
    return false;
  if (negative) *exponent = -*exponent;
  return true;
}

bool ParseDecimal(absl::string_view text, Decimal* decimal) {
  decimal->negative = ConsumeSign(text);
  const absl::string_view whole = ConsumeDigits(text);
  absl::string_view fraction;
  if (!text.empty() && text[0] == '.') {
    text.remove_prefix(1);
    fraction = ConsumeDigits(text);
  }
  int exponent;
  if (whole.empty() && fraction.empty()) return false;
  if (!ParseExponent(text, &exponent)) return false;
  decimal->digits = absl::StrCat(whole, fraction);
  decimal->point = static_cast<int>(whole.size()) + exponent;
  const size_t zeros = std::min(decimal->digits.find_first_not_of('0'), decimal->digits.size());
  decimal->digits.erase(0, zeros);
  decimal->point -= static_cast<int>(zeros);
  return true;
}

}  // namespace

absl::StatusOr<double> ParseFiniteDouble(absl::string_view text) {
  double value;
  if (!absl::SimpleAtod(text, &value)) return NotA("a number", text);
  if (!std::isfinite(value)) return NotA("a finite number", text);
  return value;
}

absl::Status ParseFiniteDoubles(absl::Span<const absl::string_view> fields,
                                absl::Span<double> values) {
  if (fields.size() != values.size()) {
    return absl::InvalidArgumentError(
        absl::StrCat(fields.size(), " numbers where ", values.size(), " are expected"));
  }
  for (size_t i = 0; i < fields.size(); ++i) {
    ASSIGN_OR_RETURN(values[i], ParseFiniteDouble(fields[i]));
  }
  return absl::OkStatus();
}

absl::StatusOr<int64_t> ParseNonNegativeInteger(absl::string_view text) {
  int64_t value;
  if (!absl::SimpleAtoi(text, &value) || value < 0) {
    return NotA("an integer from 0 to 2^63 - 1", text);
  }
  return value;
}

absl::StatusOr<Timestamp> ParseSeconds(absl::string_view text) {
  Decimal decimal;
  if (!ParseDecimal(absl::StripAsciiWhitespace(text), &decimal)) {
    return NotA("a time in seconds", text);
  }
  // Nanoseconds: the first `kept` digits, padded with zeros; the digit after them rounds.
  const int kept = decimal.point + 9;
  if (decimal.digits.empty() || kept < 0) return Timestamp{0};
  int64_t ns = 0;
  constexpr int kInt64Digits = std::numeric_limits<int64_t>::digits10 + 1;
  const bool round_up = kept < decimal.digits.size() && decimal.digits[kept] >= '5';
  if (kept <= kInt64Digits) decimal.digits.resize(kept, '0');
  const bool fits = kept <= kInt64Digits && (kept == 0 || absl::SimpleAtoi(decimal.digits, &ns)) &&
                    ns < std::numeric_limits<int64_t>::max();
  if (!fits) return NotA("a time within 292 years", text);
  ns += round_up ? 1 : 0;
  return Timestamp{decimal.negative ? -ns : ns};
}

}  // namespace overtone
