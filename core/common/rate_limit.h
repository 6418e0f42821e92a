// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CORE_COMMON_RATE_LIMIT_H_
#define OVERTONE_CORE_COMMON_RATE_LIMIT_H_

#include "absl/time/time.h"

namespace overtone {

// A token bucket: `per_s` tokens come in every second, `burst` of them fit in. Not thread-safe.
// Stamps come from any one clock; one that steps back only stands still.
class RateLimit {
 public:
  // per_s 0: no limit. burst >= 1.
  RateLimit(double per_s, double burst) : per_s_(per_s), burst_(burst), tokens_(burst) {}

  // For what may be refused. Zero: taken. Else nothing is taken, and this is when it will be there;
  // more than the burst counts as the burst.
  absl::Duration TryTake(double tokens, absl::Time now);

  // For what has happened already: may leave a debt. The result is how long to let nothing more
  // happen: until the debt is paid, and not less than `shortest` or the time that fills the burst.
  // The rate stays the same, since tokens come in meanwhile.
  absl::Duration Charge(double tokens, absl::Time now,
                        absl::Duration shortest = absl::ZeroDuration());

  bool IsFull(absl::Time now);

 private:
  void Refill(absl::Time now);
  absl::Duration Until(double missing) const { return absl::Seconds(missing / per_s_); }

  double per_s_;
  double burst_;
  double tokens_;
  absl::Time refilled_ = absl::InfinitePast();
};

}  // namespace overtone

#endif  // OVERTONE_CORE_COMMON_RATE_LIMIT_H_
