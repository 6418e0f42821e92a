// SPDX-License-Identifier: Apache-2.0
// Sends the outbox's submaps, in order, and the clouds that the server wants; takes from it what
// the server acknowledges.
#ifndef OVERTONE_CLIENT_INTERNAL_SUBMAP_UPLOADER_H_
#define OVERTONE_CLIENT_INTERNAL_SUBMAP_UPLOADER_H_

#include <cstdint>
#include <functional>
#include <string>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/client/internal/backoff.h"
#include "overtone/client/internal/blob_sender.h"
#include "overtone/client/internal/logger.h"
#include "overtone/client/internal/submap_outbox.h"
#include "overtone/client/internal/submap_sender.h"
#include "overtone/client/internal/traffic_counters.h"
#include "overtone/client/internal/upload_stream.h"
#include "overtone/core/common/ids.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {

// Owns one thread. A stream begins with the header; the server's Ready says where to go on;
// whatever breaks it (network, server, a Reject) ends it, and the next one begins with a new Ready.
// So there is one way to recover. A submap goes before any chunk of a cloud that is not under way
// yet.
class SubmapUploader {
 public:
  // The server refused this submap for good. Called from the uploader's thread, before the stream
  // is begun anew; what the outbox holds on return is sent again from where the server's Ready
  // says.
  using RefusalHandler = std::function<void(int64_t sequence, const absl::Status& reason)>;

  // The server will not have a cloud: the outbox has counted it as dropped. Called from the
  // uploader's thread.
  using DropHandler = std::function<void()>;

  // All pointers must outlive the uploader.
  SubmapUploader(v1::MappingService::Stub* stub, std::string map, MissionId mission,
                 Backoff backoff, SubmapOutbox* outbox, TrafficCounters* counters, Logger logger,
                 RefusalHandler on_refusal, DropHandler on_drop);
  ~SubmapUploader();  // cancels the stream; does not wait for the network

  // The outbox has something new.
  void Notify();

 private:
  // Where one stream stands.
  struct Progress {
    SubmapSender submaps;
    BlobSender blobs;
  };
  enum class Event { kStop, kMessage, kEnded, kCanSend };

  void Run();
  absl::Status RunStream();
  absl::Status HandleEvents(UploadStream& stream);
  Event AwaitEvent(const UploadStream& stream);
  absl::Status Handle(const v1::UploadSubmapsResponse& response, Progress& progress);
  absl::Status HandleReject(const v1::UploadReject& reject, const Progress& progress);
  absl::Status HandleBlobResult(const v1::UploadBlobResult& result, Progress& progress);
  absl::Status SendNext(UploadStream& stream, Progress& progress);

  v1::MappingService::Stub* const stub_;
  v1::UploadHeader header_;
  Backoff backoff_;
  SubmapOutbox* const outbox_;
  TrafficCounters* const counters_;
  const Logger logger_;
  const RefusalHandler on_refusal_;
  const DropHandler on_drop_;

  absl::Mutex mutex_;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  bool may_send_ ABSL_GUARDED_BY(mutex_) =
      false;            // something changed since SendNext found nothing to do
  std::thread thread_;  // last: it uses everything above
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_SUBMAP_UPLOADER_H_
