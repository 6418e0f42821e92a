// SPDX-License-Identifier: Apache-2.0
// Numbers out of text. None of these throws, allocates much or depends on the locale.
#ifndef OVERTONE_CORE_COMMON_PARSE_NUMBER_H_
#define OVERTONE_CORE_COMMON_PARSE_NUMBER_H_

#include <cstdint>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "overtone/core/common/timestamp.h"

namespace overtone {

// A finite number, decimal or scientific. InvalidArgument quotes what is there instead: words, NaN,
// infinities.
absl::StatusOr<double> ParseFiniteDouble(absl::string_view text);

// One number from each of `fields` into `values`, which must be as long.
absl::Status ParseFiniteDoubles(absl::Span<const absl::string_view> fields,
                                absl::Span<double> values);

// An integer in [0, 2^63).
absl::StatusOr<int64_t> ParseNonNegativeInteger(absl::string_view text);

// Seconds, decimal ("1403636580.83856") or scientific ("1.403636579763555527e+09"), to nanoseconds.
// Digit by digit: exact down to the nanosecond, rounded to the nearest below it. Never by way of a
// double, which would lose the last two digits of today's epoch. InvalidArgument: not such a
// number, or beyond int64 (292 years).
absl::StatusOr<Timestamp> ParseSeconds(absl::string_view text);

}  // namespace overtone

#endif  // OVERTONE_CORE_COMMON_PARSE_NUMBER_H_
