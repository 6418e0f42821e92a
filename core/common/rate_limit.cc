// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/common/rate_limit.h"

#include <algorithm>

namespace overtone {

void RateLimit::Refill(absl::Time now) {
  if (now <= refilled_) return;
  // The first time an infinite time has passed.
  tokens_ = std::min(burst_, tokens_ + absl::ToDoubleSeconds(now - refilled_) * per_s_);
  refilled_ = now;
}

absl::Duration RateLimit::TryTake(double tokens, absl::Time now) {
  if (per_s_ == 0) return absl::ZeroDuration();
  Refill(now);
  tokens = std::min(tokens, burst_);
  const absl::Duration wait = tokens_ < tokens ? Until(tokens - tokens_) : absl::ZeroDuration();
  // Less than a duration can say is rounding, not a wait.
  if (wait == absl::ZeroDuration()) tokens_ -= tokens;
  return wait;
}

absl::Duration RateLimit::Charge(double tokens, absl::Time now, absl::Duration shortest) {
  if (per_s_ == 0) return absl::ZeroDuration();
  Refill(now);
  tokens_ -= tokens;
  if (tokens_ >= 0) return absl::ZeroDuration();
  return std::max(Until(-tokens_), std::min(shortest, Until(burst_)));
}

bool RateLimit::IsFull(absl::Time now) {
  if (per_s_ == 0) return true;
  Refill(now);
  return tokens_ >= burst_;
}

}  // namespace overtone
