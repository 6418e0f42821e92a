// SPDX-License-Identifier: Apache-2.0
// Who takes how much. One for the whole server.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_QUOTA_ROBOT_QUOTAS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_QUOTA_ROBOT_QUOTAS_H_

#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/core/common/rate_limit.h"
#include "overtone/services/mapping_server/quota/quota_options.h"

namespace overtone {

// Does not step when somebody sets the clock; its zero means nothing.
absl::Time MonotonicNow();

// Thread-safe. `who` names a robot, see quota_subject.h. Refusals are ResourceExhausted with a
// quota subject and, where it is known, the delay after which another try succeeds
// (status_conversion.h).
class RobotQuotas {
 public:
  using Clock = std::function<absl::Time()>;

  explicit RobotQuotas(const QuotaOptions& options, Clock now = MonotonicNow);

  // One unary call.
  absl::Status AdmitCall(const std::string& who);

  // One more stream, as long as the result lives; opening it is a call. It holds `who` and must not
  // outlive this.
  absl::StatusOr<std::shared_ptr<const std::string>> OpenStream(const std::string& who);
  // A message was read on an open stream of theirs. The result: how long to read no other.
  absl::Duration Charge(const std::string& who, int64_t bytes);

  // What was refused or slowed since the start.
  struct Refusals {
    std::atomic<int64_t> calls{0};
    std::atomic<int64_t> streams{0};
    std::atomic<int64_t> uploads{0};  // messages after which a stream was not read for a while
  };
  const Refusals& refusals() const { return refusals_; }

  // How many robots are remembered: those with a stream, and those that have not recovered what
  // they took.
  size_t size() const;

 private:
  struct Robot {
    explicit Robot(const QuotaOptions& options)
        : messages(options.max_messages_per_s, options.messages_burst),
          bytes(options.max_bytes_per_s, options.bytes_burst),
          calls(options.max_calls_per_s, options.calls_burst) {}

    RateLimit messages;
    RateLimit bytes;
    RateLimit calls;
    int streams = 0;
  };

  absl::Status Admit(const std::string& who) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void CloseStream(const std::string& who);
  Robot& Find(const std::string& who) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Forgets those that are as new. Now and then, so that invented names take no memory for long.
  void Sweep() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const QuotaOptions options_;
  const Clock now_;
  mutable absl::Mutex mutex_;
  std::map<std::string, Robot> robots_ ABSL_GUARDED_BY(mutex_);
  Refusals refusals_;
  size_t sweep_at_ ABSL_GUARDED_BY(mutex_) = 64;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_QUOTA_ROBOT_QUOTAS_H_
