// SPDX-License-Identifier: Apache-2.0
// When to try again, and whether it makes sense to.
#ifndef OVERTONE_CLIENT_INTERNAL_BACKOFF_H_
#define OVERTONE_CLIENT_INTERNAL_BACKOFF_H_

#include <chrono>
#include <cstdint>
#include <optional>
#include <random>

#include "absl/status/status.h"
#include "absl/time/time.h"

namespace overtone {

// Exponential backoff with jitter: each delay is drawn uniformly from the upper half of a ceiling
// that doubles from `initial` to `max`, so that a team that lost its server together does not come
// back in one instant. Not thread-safe.
class Backoff {
 public:
  // 0 < initial <= max, both finite.
  Backoff(absl::Duration initial, absl::Duration max, uint64_t seed = std::random_device{}());

  absl::Duration Next();
  // As after many failures: for what does not get better soon.
  absl::Duration Longest();

  // After success: the next delay starts from `initial` again.
  void Reset() { ceiling_ = initial_; }

 private:
  const absl::Duration initial_;
  const absl::Duration max_;
  absl::Duration ceiling_;
  std::mt19937_64 random_;
};

// The server knows us and will not have us, or does not know us: trying again soon is no use, but
// an operator may change that at any time.
bool IsAccessRefused(absl::StatusCode code);

// Servers close connections that have become old, and restart; a stream that worked and then ends
// that way is begun anew at once, and nobody need hear of it. But only once in kInterval: a server
// that does so again and again is out of order. Not thread-safe.
class QuietRestart {
 public:
  using Clock = std::chrono::steady_clock;
  static constexpr Clock::duration kInterval = std::chrono::seconds(10);

  // `worked`: something was heard on the stream. `end`: how it ended.
  bool Allows(bool worked, const absl::Status& end, Clock::time_point now);

 private:
  std::optional<Clock::time_point> last_;
};

// The codes that may get better by trying again (mapping_service.proto).
bool IsRetryable(absl::StatusCode code);

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_BACKOFF_H_
