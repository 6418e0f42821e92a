// SPDX-License-Identifier: Apache-2.0
// UploadSubmaps: the submaps of one mission, in order, and the blobs of their clouds.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_UPLOAD_SUBMAPS_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_UPLOAD_SUBMAPS_H_

#include <deque>
#include <memory>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/container/flat_hash_map.h"
#include "absl/status/status.h"
#include "absl/synchronization/mutex.h"
#include "absl/types/optional.h"
#include "grpcpp/alarm.h"
#include "grpcpp/support/server_callback.h"
#include "overtone/core/common/ids.h"
#include "overtone/services/mapping_server/log_fields.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/services/mapping_server/quota/stream_quota.h"
#include "overtone/services/mapping_server/rpc/blob_assembly.h"
#include "overtone/services/mapping_server/rpc/stream_age.h"
#include "overtone/services/mapping_server/security/stream_access.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/services/mapping_server/upload_sessions.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone {

using UploadReactor = grpc::ServerBidiReactor<v1::UploadSubmapsRequest, v1::UploadSubmapsResponse>;

// Reads on while less than the window is waiting for the store, the peer takes its answers and its
// robot keeps to its quota; otherwise it stops reading, and HTTP/2's flow control stops the peer.
// Lives until gRPC is done with it and nobody else holds it.
class UploadSubmaps : public UploadReactor,
                      public UploadStream,
                      public std::enable_shared_from_this<UploadSubmaps> {
 public:
  // gRPC owns the reactor through itself. `registry` and `sessions` outlive the server's calls.
  // `request_id` is for the log.
  static UploadReactor* Start(StreamAccess access, StreamQuota quota, MapRegistry* registry,
                              UploadSessions* sessions, const ServerLimits& limits,
                              std::string request_id);

  UploadSubmaps(StreamAccess access, StreamQuota quota, MapRegistry* registry,
                UploadSessions* sessions, const ServerLimits& limits, std::string request_id);

  void End(const absl::Status& status) override;
  void Drain(const absl::Status& status) override;

  void OnReadDone(bool ok) override;
  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  // False: the stream has ended, and nobody would hear what became of the frame.
  bool BeginFrame();
  absl::Status OnFrame();
  absl::Status OnHeader(const v1::UploadHeader& header);
  void OnSubmap(const v1::Submap& message);
  // What can be refused without the store.
  absl::StatusOr<SubmapRecord> Check(const v1::Submap& message) const;
  absl::Status Append(const v1::Submap& message, int64_t bytes);
  // From the store, on any thread.
  void OnAppended(const HostedMap& map, int64_t sequence, bool has_clouds, int64_t bytes,
                  const absl::StatusOr<AppendResult>& result);
  void OnBlob(const v1::BlobChunk& chunk);
  void PutBlob(const std::shared_ptr<HostedMap>& map, const std::string& sha256, SharedBlob blob);
  void AnswerBlob(const std::string& sha256, const absl::Status& status)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Asks for what is missing as long as little is asked for, or says that nothing is.
  void AskForBlobs(const HostedMap& map) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Reject(int64_t sequence, const absl::Status& status, int64_t expected_sequence);
  int64_t NextSequence() ABSL_LOCKS_EXCLUDED(mutex_);
  std::shared_ptr<HostedMap> map() ABSL_LOCKS_EXCLUDED(mutex_);
  void CountReceived(int64_t bytes) ABSL_LOCKS_EXCLUDED(mutex_);
  // Unavailable when the stream ended meanwhile.
  absl::Status SetMap(const std::shared_ptr<HostedMap>& map) ABSL_LOCKS_EXCLUDED(mutex_);

  void Answer(v1::UploadSubmapsResponse response) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  // Whatever can go on goes on: reading, writing, the end.
  void Advance() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void PauseReading(absl::Duration pause) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void FinishWith(const absl::Status& status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  StreamAccess access_;
  MapRegistry* const registry_;
  UploadSessions* const sessions_;
  const int64_t window_bytes_;
  std::shared_ptr<UploadSubmaps> self_;  // until OnDone

  // Only touched by the one read at a time.
  v1::UploadSubmapsRequest request_;
  std::string map_id_;  // empty until the header
  MissionId mission_;
  LogFields log_;  // likewise; does not change after the header
  BlobAssembly assembly_;
  StreamQuota quota_;
  StreamAge age_;
  grpc::Alarm quota_alarm_;  // set between reads, cancelled after the last

  absl::Mutex mutex_;
  // Null until the first good submap, or when the map is there; null again once the stream is to
  // end: a peer that takes no more answers must not keep the map.
  std::shared_ptr<HostedMap> map_ ABSL_GUARDED_BY(mutex_);
  // The robot's in that map; what goes to and fro before it is there is counted with it.
  std::shared_ptr<RobotCounters> traffic_ ABSL_GUARDED_BY(mutex_);         // never null
  std::deque<v1::UploadSubmapsResponse> answers_ ABSL_GUARDED_BY(mutex_);  // front: being written
  int64_t waiting_bytes_ ABSL_GUARDED_BY(mutex_) = 0;  // with the store, not answered yet
  int waiting_ ABSL_GUARDED_BY(mutex_) = 0;            // submaps and blobs
  // Asked for and not answered yet: bytes by digest.
  absl::flat_hash_map<std::string, int64_t> asked_ ABSL_GUARDED_BY(mutex_);
  bool no_room_ ABSL_GUARDED_BY(mutex_) = false;  // for blobs: ask for no more
  bool reading_ ABSL_GUARDED_BY(mutex_) = false;
  bool handling_ ABSL_GUARDED_BY(mutex_) = false;  // a frame that was read, before it waits
  bool paused_ ABSL_GUARDED_BY(mutex_) = false;    // over the quota, until the alarm
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool half_closed_ ABSL_GUARDED_BY(mutex_) = false;  // the peer sends no more
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
  absl::optional<absl::Status> draining_ ABSL_GUARDED_BY(mutex_);  // read no more, then end so
  absl::optional<absl::Status> ending_ ABSL_GUARDED_BY(mutex_);    // after the write under way
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_UPLOAD_SUBMAPS_H_
