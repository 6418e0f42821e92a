// SPDX-License-Identifier: Apache-2.0
// A bound on what goes up in a second, for radios.
#ifndef OVERTONE_CLIENT_INTERNAL_TOKEN_BUCKET_H_
#define OVERTONE_CLIENT_INTERNAL_TOKEN_BUCKET_H_

#include <chrono>
#include <cstdint>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/core/common/rate_limit.h"

namespace overtone {

// Fills with `bytes_per_s` up to what comes in a second. A message may go whenever the bucket is
// not in debt, whatever its size, and may leave it in debt: what went is then paid off before the
// next. So over any time no more goes than rate * (time + 1 s) and one message. Thread-safe: all
// streams of a robot share one.
class TokenBucket {
 public:
  using Clock = std::chrono::steady_clock;

  // 0: no bound.
  explicit TokenBucket(int64_t bytes_per_s)
      : bytes_per_s_(bytes_per_s),
        bytes_(static_cast<double>(bytes_per_s), static_cast<double>(bytes_per_s)) {}

  // When the next message may go; not after `now`: at once.
  Clock::time_point ReadyAt(Clock::time_point now) {
    absl::MutexLock lock(&mutex_);
    return now + absl::ToChronoNanoseconds(bytes_.Charge(0, Stamp(now)));
  }

  void Take(int64_t bytes, Clock::time_point now) {
    absl::MutexLock lock(&mutex_);
    bytes_.Charge(static_cast<double>(bytes), Stamp(now));
  }

  // The largest message that leaves a debt of at most a second; 0: no bound.
  int64_t message_bytes() const { return bytes_per_s_; }

 private:
  static absl::Time Stamp(Clock::time_point time) {
    return absl::UnixEpoch() + absl::FromChrono(time.time_since_epoch());
  }

  const int64_t bytes_per_s_;
  absl::Mutex mutex_;
  RateLimit bytes_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_TOKEN_BUCKET_H_
