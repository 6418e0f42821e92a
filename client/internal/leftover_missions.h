// SPDX-License-Identifier: Apache-2.0
// Sends what earlier runs of the robot could not.
#ifndef OVERTONE_CLIENT_INTERNAL_LEFTOVER_MISSIONS_H_
#define OVERTONE_CLIENT_INTERNAL_LEFTOVER_MISSIONS_H_

#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "overtone/client/internal/backoff.h"
#include "overtone/client/internal/logger.h"
#include "overtone/client/internal/outbox_directory.h"
#include "overtone/client/internal/submap_outbox.h"
#include "overtone/client/internal/token_bucket.h"
#include "overtone/client/internal/traffic_counters.h"
#include "overtone/client/mapping_client_options.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {

// Owns one thread, and while there is something to send those of the uploaders. One mission after
// the other, beside the current one and to the maps they were recorded for. A file goes once the
// server has all that it holds. What is left otherwise:
//   in use by another client           skipped
//   the server refuses a submap        renamed to "<path>.refused"; the rest of it stays there
//   the server lost earlier submaps    stays, and is offered again at the next start
class LeftoverMissions {
 public:
  // The outboxes in options.outbox_dir of options.mission.robot, but for the current mission's. All
  // pointers must outlive this.
  LeftoverMissions(v1::MappingService::Stub* stub, const MappingClientOptions& options,
                   TrafficCounters* counters, TokenBucket* bucket, Logger logger);
  ~LeftoverMissions();  // does not wait for the network

  // Missions of which something is left.
  int64_t waiting() const { return waiting_; }

 private:
  enum class End { kAllSent, kStopped, kRefused, kGap };

  void Run();
  void Handle(const MissionOutbox& mission);
  End Send(const MissionOutbox& mission, SubmapOutbox& outbox);
  bool Hold(SubmapOutbox* outbox) ABSL_LOCKS_EXCLUDED(mutex_);

  v1::MappingService::Stub* const stub_;
  const MappingClientOptions options_;
  TrafficCounters* const counters_;
  TokenBucket* const bucket_;
  const Logger logger_;
  const std::vector<MissionOutbox> missions_;
  std::atomic<int64_t> waiting_;

  absl::Mutex mutex_;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  SubmapOutbox* outbox_ ABSL_GUARDED_BY(mutex_) = nullptr;  // the one being sent
  std::thread thread_;                                      // last: it uses everything above
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_LEFTOVER_MISSIONS_H_
