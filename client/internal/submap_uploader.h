// SPDX-License-Identifier: Apache-2.0
// Sends the outbox's submaps, in order, and the clouds that the server wants; takes from it what
// the server acknowledges.
#ifndef OVERTONE_CLIENT_INTERNAL_SUBMAP_UPLOADER_H_
#define OVERTONE_CLIENT_INTERNAL_SUBMAP_UPLOADER_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/client/internal/backoff.h"
#include "overtone/client/internal/blob_sender.h"
#include "overtone/client/internal/logger.h"
#include "overtone/client/internal/submap_outbox.h"
#include "overtone/client/internal/submap_sender.h"
#include "overtone/client/internal/token_bucket.h"
#include "overtone/client/internal/traffic_counters.h"
#include "overtone/client/internal/upload_submaps_stream.h"
#include "overtone/core/common/ids.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {

// Owns one thread. A stream begins with the header; the server's Ready says where to go on;
// whatever breaks it (network, server, a Reject) ends it, and the next one begins with a new Ready.
// So there is one way to recover. A submap goes before any chunk of a cloud that is not under way
// yet.
class SubmapUploader {
 public:
  struct Settings {
    std::string map;
    MissionId mission;
    Backoff backoff;
    // A stream on which so long nothing moves, though the server owes an answer, is given up. Dead
    // links are found sooner, by the channel's keepalive; this is for a server that stands still.
    absl::Duration stall_timeout = absl::Minutes(5);
    TokenBucket* bucket = nullptr;  // shared; null: no bound
  };

  // All are called from the uploader's thread.
  struct Listener {
    // The server refused this submap for good. What the outbox holds on return is sent again from
    // where the server's next Ready says.
    std::function<void(int64_t sequence, const absl::Status& reason)> on_refusal;
    // The server will not have a cloud: the outbox has counted it as dropped.
    std::function<void()> on_drop;
    // The server expects a submap that is not there any more: it lost what it had acknowledged, or
    // an operator deleted the mission, or the outbox was damaged. `first_waiting` and what follows
    // it stays, and is offered again and again, slowly. Told once until submaps go up again.
    std::function<void(int64_t first_waiting, const absl::Status& reason)> on_gap;
  };

  // All pointers must outlive the uploader.
  SubmapUploader(v1::MappingService::Stub* stub, Settings settings, SubmapOutbox* outbox,
                 TrafficCounters* counters, Logger logger, Listener listener);
  ~SubmapUploader();  // cancels the stream; does not wait for the network

  // The outbox has something new.
  void Notify();

 private:
  using Clock = std::chrono::steady_clock;
  // Where one stream stands.
  struct Progress {
    SubmapSender submaps;
    BlobSender blobs;
    Clock::time_point last_move = Clock::now();  // when a message came or went

    bool AwaitsAnswer() const { return !submaps.ready() || BytesInFlight() > 0; }
    int64_t BytesInFlight() const { return submaps.bytes_in_flight() + blobs.bytes_in_flight(); }
  };
  enum class Event { kStop, kMessage, kEnded, kCanSend, kStalled };

  void Run();
  absl::Duration DelayAfter(const absl::Status& status);
  absl::Status RunStream();
  absl::Status HandleEvents(UploadSubmapsStream& stream);
  Event AwaitEvent(const UploadSubmapsStream& stream, const Progress& progress);
  absl::Status Handle(const v1::UploadSubmapsResponse& response, Progress& progress);
  absl::Status HandleReject(const v1::UploadReject& reject, const Progress& progress);
  absl::Status HandleBlobResult(const v1::UploadBlobResult& result, Progress& progress);
  absl::Status SendNext(UploadSubmapsStream& stream, Progress& progress);
  absl::StatusOr<std::optional<v1::UploadSubmapsRequest>> NextRequest(Progress& progress);
  void Count(int64_t bytes);

  v1::MappingService::Stub* const stub_;
  Settings settings_;
  v1::UploadHeader header_;
  SubmapOutbox* const outbox_;
  TrafficCounters* const counters_;
  const Logger logger_;
  const Listener listener_;

  // The thread's own.
  QuietRestart quiet_restart_;
  bool heard_ = false;  // something, on this stream
  bool gap_told_ = false;

  absl::Mutex mutex_;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  bool may_send_ ABSL_GUARDED_BY(mutex_) =
      false;            // something changed since SendNext found nothing to do
  std::thread thread_;  // last: it uses everything above
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_SUBMAP_UPLOADER_H_
