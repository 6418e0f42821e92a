// SPDX-License-Identifier: Apache-2.0
// WatchGraph: every new revision of a map's graph, newest wins. The bytes come serialised from the
// publisher and are shared between readers, hence the raw method.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_RPC_WATCH_GRAPH_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_RPC_WATCH_GRAPH_H_

#include <cstdint>
#include <memory>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/types/optional.h"
#include "grpcpp/support/byte_buffer.h"
#include "grpcpp/support/server_callback.h"
#include "overtone/services/mapping_server/graph_publisher.h"
#include "overtone/services/mapping_server/map_registry.h"
#include "overtone/services/mapping_server/quota/stream_quota.h"
#include "overtone/services/mapping_server/rpc/stream_age.h"
#include "overtone/services/mapping_server/security/stream_access.h"
#include "overtone/services/mapping_server/server_options.h"
#include "overtone/v1/mapping_service.pb.h"

namespace overtone {

using WatchReactor = grpc::ServerWriteReactor<grpc::ByteBuffer>;

// Lives until gRPC and the publisher are done with it.
class WatchGraph : public WatchReactor,
                   public GraphReader,
                   public std::enable_shared_from_this<WatchGraph> {
 public:
  // `registry` outlives the server's calls.
  static WatchReactor* Start(StreamAccess access, StreamQuota quota, MapRegistry* registry,
                             const ServerOptions& options, const grpc::ByteBuffer& request);

  WatchGraph(StreamAccess access, StreamQuota quota)
      : access_(std::move(access)), quota_(std::move(quota)) {}

  void Send(const grpc::ByteBuffer& frame, uint64_t revision) override;
  void End(const absl::Status& status) override;
  // There is nothing to wait for but the frame under way.
  void Drain(const absl::Status& status) { End(status); }

  void OnWriteDone(bool ok) override;
  void OnCancel() override;
  void OnDone() override;

 private:
  absl::Status Subscribe(MapRegistry* registry, int server_max_nodes,
                         const grpc::ByteBuffer& request);
  void FinishWith(const absl::Status& status) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  StreamAccess access_;
  StreamQuota quota_;
  StreamAge age_;
  std::shared_ptr<WatchGraph> self_;  // until OnDone

  absl::Mutex mutex_;
  // Until it ends: a peer that takes no more frames must not keep the map. Null for requests that
  // were refused. May be let go on any thread (MapRegistry::Share).
  std::shared_ptr<HostedMap> map_ ABSL_GUARDED_BY(mutex_);
  grpc::ByteBuffer frame_ ABSL_GUARDED_BY(mutex_);                  // being written
  uint64_t revision_ ABSL_GUARDED_BY(mutex_) = 0;                   // that the peer has with it
  std::shared_ptr<RobotCounters> traffic_ ABSL_GUARDED_BY(mutex_);  // null: no robot watches
  bool writing_ ABSL_GUARDED_BY(mutex_) = false;
  bool finished_ ABSL_GUARDED_BY(mutex_) = false;
  absl::optional<absl::Status> ending_ ABSL_GUARDED_BY(mutex_);  // after the write under way
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_RPC_WATCH_GRAPH_H_
