// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/log_limit.h"

namespace overtone {

absl::optional<int64_t> LogLimit::Admit(const char* cause, absl::Time now) {
  absl::MutexLock lock(&mutex_);
  const RateLimit lines(1 / absl::ToDoubleSeconds(interval_), burst_);
  Cause& entry = causes_.emplace(cause, Cause{lines}).first->second;
  if (entry.lines.TryTake(1, now) > absl::ZeroDuration()) {
    ++entry.left_out;
    return absl::nullopt;
  }
  return std::exchange(entry.left_out, 0);
}

LogLimit& PeerLogLimit() {
  static LogLimit limit(10, absl::Seconds(10));
  return limit;
}

}  // namespace overtone
