// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/report_conversion.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "absl/strings/ascii.h"
#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/id_conversion.h"

namespace overtone {
namespace {

constexpr int32_t kNanosecondsPerSecond = 1'000'000'000;
constexpr int64_t kMaxSeconds = 4'000'000'000;  // year 2096, as stamps

absl::Status NotNegative(absl::string_view field, int64_t value) {
  if (value >= 0) return absl::OkStatus();
  return InvalidField(field, absl::StrCat(value, " is negative"));
}

// Also refuses NaN.
absl::Status FiniteAndNotNegative(absl::string_view field, double value) {
  if (std::isfinite(value) && value >= 0) return absl::OkStatus();
  return InvalidField(field, absl::StrCat(value, " is not a finite number from 0"));
}

absl::Status Text(absl::string_view field, absl::string_view text, size_t max_bytes) {
  if (text.size() > max_bytes) {
    return InvalidField(field, absl::StrCat(text.size(), " bytes, at most ", max_bytes));
  }
  if (std::none_of(text.begin(), text.end(), absl::ascii_iscntrl)) return absl::OkStatus();
  return InvalidField(field, "has control characters");
}

// As google.protobuf.Duration: the nanoseconds have the sign of the seconds.
absl::Status InRange(absl::string_view field, const google::protobuf::Duration& duration) {
  const int64_t seconds = duration.seconds();
  const int32_t nanos = duration.nanos();
  const bool same_sign = (seconds >= 0 && nanos >= 0) || (seconds <= 0 && nanos <= 0);
  if (seconds >= -kMaxSeconds && seconds <= kMaxSeconds && nanos > -kNanosecondsPerSecond &&
      nanos < kNanosecondsPerSecond && same_sign) {
    return absl::OkStatus();
  }
  return InvalidField(
      field, absl::StrCat(seconds, " s and ", nanos, " ns are not a duration within 4e9 s"));
}

absl::Status ValidateTime(const google::protobuf::Timestamp& time) {
  if (time.seconds() >= 0 && time.seconds() <= kMaxSeconds && time.nanos() >= 0 &&
      time.nanos() < kNanosecondsPerSecond) {
    return absl::OkStatus();
  }
  return InvalidField("time", absl::StrCat(time.seconds(), " s and ", time.nanos(),
                                           " ns are not a time within 4e9 s of 1970"));
}

absl::Status ValidateIndices(const v1::ComparisonReport& comparison) {
  if (comparison.index_size() > report_limits::kMaxNodes) {
    return InvalidField("index", absl::StrCat(comparison.index_size(), " nodes, at most ",
                                              report_limits::kMaxNodes));
  }
  for (int i = 0; i < comparison.index_size(); ++i) {
    RETURN_IF_ERROR(ValidateKeyframeIndex(comparison.index(i), absl::StrCat("index[", i, "]")));
    if (i == 0 || comparison.index(i) > comparison.index(i - 1)) continue;
    return InvalidField(absl::StrCat("index[", i, "]"), "not larger than the one before");
  }
  return absl::OkStatus();
}

absl::Status ValidateColumn(absl::string_view field,
                            const google::protobuf::RepeatedField<float>& column, int size) {
  if (column.size() != size) {
    return InvalidField(field, absl::StrCat(column.size(), " values for ", size, " nodes"));
  }
  for (int i = 0; i < size; ++i) {
    RETURN_IF_ERROR(FiniteAndNotNegative(absl::StrCat(field, "[", i, "]"), column.Get(i)));
  }
  return absl::OkStatus();
}

absl::Status ValidateLevel(absl::string_view field, const v1::BandLevel& level) {
  RETURN_IF_ERROR(FiniteAndNotNegative(absl::StrCat(field, ".noise"), level.noise()));
  return FiniteAndNotNegative(absl::StrCat(field, ".largest"), level.largest());
}

absl::Status ValidateConstraints(const v1::ComparisonReport& comparison) {
  if (comparison.constraints_size() > report_limits::kMaxConstraintCounts) {
    return InvalidField("constraints", absl::StrCat(comparison.constraints_size(), ", at most ",
                                                    report_limits::kMaxConstraintCounts));
  }
  for (int i = 0; i < comparison.constraints_size(); ++i) {
    RETURN_IF_ERROR(
        AtField("constraints", i, NotNegative("added", comparison.constraints(i).added())));
  }
  if (comparison.largest_size() > report_limits::kMaxConstraintEnds) {
    return InvalidField("largest", absl::StrCat(comparison.largest_size(), ", at most ",
                                                report_limits::kMaxConstraintEnds));
  }
  for (int i = 0; i < comparison.largest_size(); ++i) {
    const v1::ConstraintEnds& ends = comparison.largest(i);
    RETURN_IF_ERROR(AtField("largest", i, ValidateKeyframeIndex(ends.from(), "from")));
    RETURN_IF_ERROR(AtField("largest", i, ValidateKeyframeIndex(ends.to(), "to")));
    RETURN_IF_ERROR(AtField("largest", i, FiniteAndNotNegative("score", ends.score())));
  }
  return absl::OkStatus();
}

}  // namespace

absl::Status Validate(const v1::LinkReport& link) {
  RETURN_IF_ERROR(NotNegative("submaps_waiting", link.submaps_waiting()));
  RETURN_IF_ERROR(NotNegative("blobs_waiting", link.blobs_waiting()));
  RETURN_IF_ERROR(NotNegative("bytes_waiting", link.bytes_waiting()));
  RETURN_IF_ERROR(NotNegative("bytes_sent", link.bytes_sent()));
  RETURN_IF_ERROR(NotNegative("bytes_received", link.bytes_received()));
  RETURN_IF_ERROR(NotNegative("report_bytes_sent", link.report_bytes_sent()));
  RETURN_IF_ERROR(NotNegative("reconnects", link.reconnects()));
  RETURN_IF_ERROR(NotNegative("clouds_dropped", link.clouds_dropped()));
  RETURN_IF_ERROR(InRange("clock_offset", link.clock_offset()));
  RETURN_IF_ERROR(InRange("clock_offset_uncertainty", link.clock_offset_uncertainty()));
  const auto& uncertainty = link.clock_offset_uncertainty();
  RETURN_IF_ERROR(NotNegative("clock_offset_uncertainty.seconds", uncertainty.seconds()));
  RETURN_IF_ERROR(NotNegative("clock_offset_uncertainty.nanos", uncertainty.nanos()));
  return Text("client_version", link.client_version(), report_limits::kMaxVersionBytes);
}

absl::Status Validate(const v1::ComparisonReport& comparison) {
  RETURN_IF_ERROR(ValidateTime(comparison.time()));
  RETURN_IF_ERROR(NotNegative("nodes", comparison.nodes()));
  RETURN_IF_ERROR(FiniteAndNotNegative("duration_s", comparison.duration_s()));
  RETURN_IF_ERROR(ValidateIndices(comparison));
  RETURN_IF_ERROR(ValidateColumn("small", comparison.small(), comparison.index_size()));
  RETURN_IF_ERROR(ValidateColumn("mid", comparison.mid(), comparison.index_size()));
  RETURN_IF_ERROR(ValidateColumn("large", comparison.large(), comparison.index_size()));
  RETURN_IF_ERROR(ValidateConstraints(comparison));
  RETURN_IF_ERROR(NotNegative("updated", comparison.updated()));
  RETURN_IF_ERROR(NotNegative("retracted", comparison.retracted()));
  RETURN_IF_ERROR(FiniteAndNotNegative("rmse_before_m", comparison.rmse_before_m()));
  RETURN_IF_ERROR(FiniteAndNotNegative("predicted_rmse_m", comparison.predicted_rmse_m()));
  RETURN_IF_ERROR(ValidateLevel("small_level", comparison.small_level()));
  RETURN_IF_ERROR(ValidateLevel("mid_level", comparison.mid_level()));
  RETURN_IF_ERROR(ValidateLevel("large_level", comparison.large_level()));
  return Text("held_back", comparison.held_back(), report_limits::kMaxHeldBackBytes);
}

}  // namespace overtone
