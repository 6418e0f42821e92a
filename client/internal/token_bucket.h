// SPDX-License-Identifier: Apache-2.0
// A bound on what goes up in a second, for radios.
#ifndef OVERTONE_CLIENT_INTERNAL_TOKEN_BUCKET_H_
#define OVERTONE_CLIENT_INTERNAL_TOKEN_BUCKET_H_

#include <chrono>
#include <cstdint>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"

namespace overtone {

// Fills with `bytes_per_s` up to what comes in a second. A message may go whenever the bucket is
// not in debt, whatever its size, and may leave it in debt: what went is then paid off before the
// next. So over any time no more goes than rate * (time + 1 s) and one message. Thread-safe: all
// streams of a robot share one.
class TokenBucket {
 public:
  using Clock = std::chrono::steady_clock;

  // 0: no bound.
  explicit TokenBucket(int64_t bytes_per_s, Clock::time_point now = Clock::now())
      : bytes_per_s_(bytes_per_s), balance_(static_cast<double>(bytes_per_s)), at_(now) {}

  // When the next message may go; not after `now`: at once.
  Clock::time_point ReadyAt(Clock::time_point now) {
    if (bytes_per_s_ == 0) return now;
    absl::MutexLock lock(&mutex_);
    Fill(now);
    if (balance_ >= 0) return now;
    return now + std::chrono::duration_cast<Clock::duration>(
                     std::chrono::duration<double>(-balance_ / static_cast<double>(bytes_per_s_)));
  }

  void Take(int64_t bytes, Clock::time_point now) {
    if (bytes_per_s_ == 0) return;
    absl::MutexLock lock(&mutex_);
    Fill(now);
    balance_ -= static_cast<double>(bytes);
  }

  // The largest message that leaves a debt of at most a second; 0: no bound.
  int64_t message_bytes() const { return bytes_per_s_; }

 private:
  void Fill(Clock::time_point now) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    if (now <= at_) return;
    const double rate = static_cast<double>(bytes_per_s_);
    balance_ += rate * std::chrono::duration<double>(now - at_).count();
    if (balance_ > rate) balance_ = rate;
    at_ = now;
  }

  const int64_t bytes_per_s_;
  absl::Mutex mutex_;
  double balance_ ABSL_GUARDED_BY(mutex_);  // bytes; negative: debt
  Clock::time_point at_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_TOKEN_BUCKET_H_
