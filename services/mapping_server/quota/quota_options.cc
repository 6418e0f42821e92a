// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/quota/quota_options.h"

#include "absl/strings/str_cat.h"
#include "absl/strings/string_view.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"

namespace overtone {
namespace {

// Large enough for any host, and sums of them stay exact.
constexpr double kMost = 1e12;

absl::Status ValidateRate(absl::string_view rate_name, double rate, absl::string_view burst_name,
                          double burst) {
  if (!(rate == 0 || (rate >= 1e-3 && rate <= kMost))) {
    return InvalidField(rate_name, absl::StrCat(rate, " is neither 0 nor in [0.001, 1e12]"));
  }
  if (burst >= 1 && burst <= kMost) return absl::OkStatus();
  return InvalidField(burst_name, absl::StrCat(burst, " is not in [1, 1e12]"));
}

}  // namespace

absl::Status QuotaOptions::Validate() const {
  if (max_streams < 0 || max_streams > 1'000'000) {
    return InvalidField("max_streams", absl::StrCat(max_streams, " is not in [0, 1000000]"));
  }
  RETURN_IF_ERROR(
      ValidateRate("max_messages_per_s", max_messages_per_s, "messages_burst", messages_burst));
  RETURN_IF_ERROR(ValidateRate("max_bytes_per_s", max_bytes_per_s, "bytes_burst", bytes_burst));
  return ValidateRate("max_calls_per_s", max_calls_per_s, "calls_burst", calls_burst);
}

}  // namespace overtone
