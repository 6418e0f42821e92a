// SPDX-License-Identifier: Apache-2.0
// For whatever a peer can make us log as often as it likes.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_LOG_LIMIT_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_LOG_LIMIT_H_

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "absl/types/optional.h"
#include "overtone/core/common/rate_limit.h"
#include "overtone/services/mapping_server/quota/robot_quotas.h"
#include "spdlog/spdlog.h"

namespace overtone {

// Of each cause the first few lines at once, then one in each interval; quiet times give the few
// back. A cause is a fixed text of ours, never a peer's. Thread-safe.
class LogLimit {
 public:
  LogLimit(int burst, absl::Duration interval) : burst_(burst), interval_(interval) {}

  // Nullopt: to be left out. Else how many of this cause were left out since its last line.
  absl::optional<int64_t> Admit(const char* cause, absl::Time now);

 private:
  struct Cause {
    RateLimit lines;
    int64_t left_out = 0;
  };

  const int burst_;
  const absl::Duration interval_;
  absl::Mutex mutex_;
  std::map<std::string, Cause> causes_ ABSL_GUARDED_BY(mutex_);
};

// Of the process, as the log is: 10 lines of each cause, then one in 10 s.
LogLimit& PeerLogLimit();

// What a peer caused. Text that comes from the peer goes through HeaderSafe first.
template <typename... Args>
void LogPeer(spdlog::level::level_enum level, const char* cause,
             spdlog::format_string_t<Args...> format, Args&&... args) {
  if (!spdlog::should_log(level)) return;
  const absl::optional<int64_t> left_out = PeerLogLimit().Admit(cause, MonotonicNow());
  if (!left_out.has_value()) return;
  spdlog::log(level, format, std::forward<Args>(args)...);
  if (*left_out > 0)
    spdlog::log(level, "{}: {} more like the last were left out", cause, *left_out);
}

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_LOG_LIMIT_H_
