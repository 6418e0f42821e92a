// SPDX-License-Identifier: Apache-2.0
// Tells the server now and then how this robot fares. Nothing depends on it: what is not told is
// not told later.
#ifndef OVERTONE_CLIENT_INTERNAL_STATUS_REPORTER_H_
#define OVERTONE_CLIENT_INTERNAL_STATUS_REPORTER_H_

#include <chrono>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "grpcpp/client_context.h"
#include "overtone/client/internal/logger.h"
#include "overtone/client/internal/report_messages.h"
#include "overtone/client/internal/token_bucket.h"
#include "overtone/client/internal/traffic_counters.h"
#include "overtone/core/common/ids.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {

// Owns one thread from Start to Stop. After each comparison a report goes out, and one without
// where none came for `interval`. One call is under way at a time; a comparison that comes
// meanwhile replaces the one that waits. Thread-safe.
class StatusReporter {
 public:
  struct Settings {
    std::string map;
    MissionId mission;
    absl::Duration interval;
    // Not more often, however fast comparisons come.
    absl::Duration min_gap = absl::Seconds(1);
    // Of the link, for reports to keep to a twentieth of it; 0: no bound.
    int64_t max_upload_bytes_per_s = 0;
    // A server that does not know the call, or takes no such report, may have been renewed by then.
    absl::Duration refused_pause = absl::Minutes(10);
  };
  // Of now; called on the reporter's thread.
  using LinkSource = std::function<v1::LinkReport()>;

  // All pointers outlive the reporter, what `link` refers to need only live until Stop. `bucket`
  // is charged, and waited for: what the host hands over goes first.
  StatusReporter(v1::MappingService::Stub* stub, Settings settings, LinkSource link,
                 TrafficCounters* counters, TokenBucket* bucket, Logger logger);
  ~StatusReporter() { Stop(); }

  void Start();
  // Cancels the call under way; does not wait for the network. Comparisons that come after it
  // count for nothing.
  void Stop();

  // Returns at once.
  void OnComparison(const SynchronizationReport& report);

 private:
  using Clock = TokenBucket::Clock;

  void Run();
  // When a report is due and the link can carry it. False: stop.
  bool AwaitDue();
  Clock::time_point DueAt() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Report();
  absl::Status Call(const v1::ReportStatusRequest& request, v1::ReportStatusResponse& response);
  void OnTaken(const v1::ReportStatusResponse& response);
  // What nobody heard may be told later, if nothing newer has come by then.
  void OnNotTaken(const absl::Status& status, v1::ReportStatusRequest& request);

  v1::MappingService::Stub* const stub_;
  const Settings settings_;
  const LinkSource link_;
  TrafficCounters* const counters_;
  TokenBucket* const bucket_;
  const Logger logger_;
  const ReportDetail detail_;
  TokenBucket share_;  // of the link's, that is the reports'

  absl::Mutex mutex_;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::optional<v1::ComparisonReport> comparison_ ABSL_GUARDED_BY(mutex_);  // not told yet
  absl::Duration interval_ ABSL_GUARDED_BY(mutex_);  // settings_', or what the server asks for
  Clock::time_point not_before_ ABSL_GUARDED_BY(mutex_);
  Clock::time_point last_ ABSL_GUARDED_BY(mutex_);               // when the last one went out
  grpc::ClientContext* call_ ABSL_GUARDED_BY(mutex_) = nullptr;  // the one under way
  std::thread thread_;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_STATUS_REPORTER_H_
