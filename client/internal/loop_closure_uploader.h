// SPDX-License-Identifier: Apache-2.0
// Sends the outbox's batches of loop closures, one unary call after the other.
#ifndef OVERTONE_CLIENT_INTERNAL_LOOP_CLOSURE_UPLOADER_H_
#define OVERTONE_CLIENT_INTERNAL_LOOP_CLOSURE_UPLOADER_H_

#include <functional>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "grpcpp/client_context.h"
#include "overtone/client/internal/backoff.h"
#include "overtone/client/internal/logger.h"
#include "overtone/client/internal/submap_outbox.h"
#include "overtone/client/internal/token_bucket.h"
#include "overtone/client/internal/traffic_counters.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {

// Owns one thread. A batch leaves the outbox when the server has stored it or refused it for good;
// the server stores a closure once however often it comes, so a lost answer does no harm. NotFound
// is for good only when no submap waits any more: a map comes into being with its first one.
class LoopClosureUploader {
 public:
  // The server refused the oldest batch for good. Called from the uploader's thread.
  using RefusalHandler = std::function<void(const absl::Status& reason)>;

  // All pointers must outlive the uploader. Batches are small: they do not wait for `bucket`, but
  // what they take is missing in it.
  LoopClosureUploader(v1::MappingService::Stub* stub, Backoff backoff, SubmapOutbox* outbox,
                      TrafficCounters* counters, Logger logger, RefusalHandler on_refusal,
                      TokenBucket* bucket = nullptr);
  ~LoopClosureUploader();  // cancels the call; does not wait for the network

  // The outbox has something new.
  void Notify();

 private:
  void Run();
  bool AwaitWork();  // false: stop
  absl::Status SendFront();
  absl::Status Call(const v1::AddLoopClosuresRequest& request);

  v1::MappingService::Stub* const stub_;
  Backoff backoff_;
  SubmapOutbox* const outbox_;
  TrafficCounters* const counters_;
  const Logger logger_;
  const RefusalHandler on_refusal_;
  TokenBucket* const bucket_;

  absl::Mutex mutex_;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  bool has_work_ ABSL_GUARDED_BY(mutex_) = true;                 // look once at the start
  grpc::ClientContext* call_ ABSL_GUARDED_BY(mutex_) = nullptr;  // the one under way
  std::thread thread_;                                           // last: it uses everything above
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_LOOP_CLOSURE_UPLOADER_H_
