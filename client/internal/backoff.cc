// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/backoff.h"

#include <algorithm>

namespace overtone {

Backoff::Backoff(absl::Duration initial, absl::Duration max, uint64_t seed)
    : initial_(initial), max_(max), ceiling_(initial), random_(seed) {}

absl::Duration Backoff::Next() {
  const double share = std::uniform_real_distribution<double>(0.5, 1.0)(random_);
  const absl::Duration delay = share * ceiling_;
  ceiling_ = std::min(2 * ceiling_, max_);
  return delay;
}

bool IsAccessRefused(absl::StatusCode code) {
  return code == absl::StatusCode::kUnauthenticated || code == absl::StatusCode::kPermissionDenied;
}

absl::Duration Backoff::Longest() {
  ceiling_ = max_;
  return Next();
}

bool QuietRestart::Allows(bool worked, const absl::Status& end, Clock::time_point now) {
  if (!worked || !(end.ok() || absl::IsUnavailable(end))) return false;
  if (last_.has_value() && now - *last_ < kInterval) return false;
  last_ = now;
  return true;
}

bool IsRetryable(absl::StatusCode code) {
  switch (code) {
    case absl::StatusCode::kUnavailable:
    case absl::StatusCode::kDeadlineExceeded:
    case absl::StatusCode::kResourceExhausted:
    case absl::StatusCode::kAborted:
      return true;
    default:
      return false;
  }
}

}  // namespace overtone
