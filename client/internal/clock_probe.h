// SPDX-License-Identifier: Apache-2.0
// Asks the server for the time, now and then.
#ifndef OVERTONE_CLIENT_INTERNAL_CLOCK_PROBE_H_
#define OVERTONE_CLIENT_INTERNAL_CLOCK_PROBE_H_

#include <chrono>
#include <memory>
#include <optional>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "grpcpp/client_context.h"
#include "overtone/client/internal/clock_offset.h"
#include "overtone/client/internal/logger.h"
#include "overtone/client/internal/traffic_counters.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {

// GetServerInfo is the question: a heartbeat alone has no round trip to bound what it says. No
// thread of its own: whoever hears from the server says so, and that is when a question is due or
// not. Thread-safe.
class ClockProbe {
 public:
  // `warn_above`: of the offset.
  ClockProbe(v1::MappingService::Stub* stub, absl::Duration warn_above, TrafficCounters* counters,
             Logger logger);
  ~ClockProbe();  // cancels the question under way; does not wait for the network

  // The link works. Returns at once.
  void OnHeard();

  std::optional<ClockOffset::Estimate> Offset() const;

 private:
  using Clock = std::chrono::steady_clock;
  struct Question {
    grpc::ClientContext context;
    v1::GetServerInfoRequest request;
    v1::GetServerInfoResponse response;
    absl::Time sent;
    Clock::time_point sent_steady;
  };

  void OnAnswer(const grpc::Status& status);
  void Learn(Clock::time_point received) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Tell(ClockWarning::Word word, const ClockOffset::Estimate& estimate) const;

  v1::MappingService::Stub* const stub_;
  TrafficCounters* const counters_;
  const Logger logger_;

  mutable absl::Mutex mutex_;
  std::unique_ptr<Question> question_ ABSL_GUARDED_BY(mutex_);  // null: none is under way
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  int answers_ ABSL_GUARDED_BY(mutex_) = 0;
  Clock::time_point next_ ABSL_GUARDED_BY(mutex_);
  ClockOffset offset_ ABSL_GUARDED_BY(mutex_);
  ClockWarning warning_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_CLOCK_PROBE_H_
