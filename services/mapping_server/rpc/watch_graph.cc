// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/rpc/watch_graph.h"

#include <string>
#include <utility>

#include "grpcpp/impl/codegen/proto_utils.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {
namespace {

absl::StatusOr<v1::WatchGraphRequest> Parse(grpc::ByteBuffer bytes) {
  v1::WatchGraphRequest request;
  const grpc::Status status =
      grpc::SerializationTraits<v1::WatchGraphRequest>::Deserialize(&bytes, &request);
  if (!status.ok()) return absl::InvalidArgumentError("request: not a WatchGraphRequest");
  return request;
}

}  // namespace

WatchReactor* WatchGraph::Start(StreamAccess access, StreamQuota quota, MapRegistry* registry,
                                const ServerOptions& options, const grpc::ByteBuffer& request) {
  auto reactor = std::make_shared<WatchGraph>(std::move(access), std::move(quota));
  reactor->self_ = reactor;
  const absl::Status status = reactor->Subscribe(registry, options.graph.max_nodes, request);
  if (!status.ok()) reactor->End(status);
  reactor->age_.Start(absl::Seconds(options.limits.max_connection_age_s), std::weak_ptr(reactor));
  return reactor.get();
}

absl::Status WatchGraph::Subscribe(MapRegistry* registry, int server_max_nodes,
                                   const grpc::ByteBuffer& bytes) {
  RETURN_IF_ERROR(quota_.Open());
  ASSIGN_OR_RETURN(const v1::WatchGraphRequest request, Parse(bytes));
  RETURN_IF_ERROR(access_.MayRead(request.map(), weak_from_this()));
  Subscription subscription;
  ASSIGN_OR_RETURN(subscription.query, ReadQuery(request.options(), server_max_nodes));
  ASSIGN_OR_RETURN(subscription.encoding,
                   ReadEncoding(request.options(), v1::GRAPH_ENCODING_COMPACT));
  subscription.position = {request.map_epoch(), request.after_revision()};
  // A robot may well watch before its first submap: then the map is waited for.
  ASSIGN_OR_RETURN(const std::shared_ptr<HostedMap> map, registry->Acquire(request.map()));
  {
    absl::MutexLock lock(&mutex_);
    map_ = map;
    const std::string robot = quota_.RobotName(request.options().robot());
    if (!robot.empty()) traffic_ = map->traffic().Of(robot);
    if (traffic_ != nullptr) ++traffic_->watches;
  }
  map->publisher().Subscribe(shared_from_this(), std::move(subscription));
  return absl::OkStatus();
}

void WatchGraph::Send(const grpc::ByteBuffer& frame, uint64_t revision) {
  absl::MutexLock lock(&mutex_);
  if (finished_ || ending_.has_value()) return;
  frame_ = frame;
  revision_ = revision;
  if (traffic_ != nullptr) traffic_->bytes_sent += static_cast<int64_t>(frame.Length());
  writing_ = true;
  StartWrite(&frame_);
}

void WatchGraph::End(const absl::Status& status) {
  absl::MutexLock lock(&mutex_);
  if (finished_) return;
  map_.reset();
  ending_ = status;
  if (!writing_) FinishWith(status);
}

void WatchGraph::OnWriteDone(bool ok) {
  std::shared_ptr<HostedMap> map;
  {
    absl::MutexLock lock(&mutex_);
    writing_ = false;
    frame_.Clear();
    if (ok && traffic_ != nullptr) traffic_->revision_sent = revision_;
    if (finished_) return;
    if (ending_.has_value()) return FinishWith(*ending_);
    if (!ok) return FinishWith(absl::CancelledError("the peer is gone"));
    map = map_;
  }
  map->publisher().Ready(this);
}

void WatchGraph::OnCancel() {
  absl::MutexLock lock(&mutex_);
  if (!finished_) FinishWith(absl::CancelledError("the peer is gone"));
}

void WatchGraph::FinishWith(const absl::Status& status) {
  finished_ = true;
  Finish(ToGrpcStatus(status));
}

void WatchGraph::OnDone() {
  std::shared_ptr<HostedMap> map;
  {
    absl::MutexLock lock(&mutex_);
    map = std::move(map_);
    if (traffic_ != nullptr) --traffic_->watches;
  }
  if (map != nullptr) map->publisher().Unsubscribe(this);
  quota_.Close();
  age_.Stop();
  self_.reset();
}

}  // namespace overtone
