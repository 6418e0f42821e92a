// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/mapping_client.h"

#include <string>
#include <utility>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/strings/str_cat.h"
#include "absl/synchronization/mutex.h"
#include "grpcpp/channel.h"
#include "overtone/client/internal/backoff.h"
#include "overtone/client/internal/channel.h"
#include "overtone/client/internal/channel_credentials.h"
#include "overtone/client/internal/cloud_encoding.h"
#include "overtone/client/internal/exception_guard.h"
#include "overtone/client/internal/graph_subscriber.h"
#include "overtone/client/internal/host_thread.h"
#include "overtone/client/internal/logger.h"
#include "overtone/client/internal/loop_closure_uploader.h"
#include "overtone/client/internal/submap_outbox.h"
#include "overtone/client/internal/submap_sequence.h"
#include "overtone/client/internal/submap_uploader.h"
#include "overtone/client/internal/traffic_counters.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {
namespace {

v1::WatchGraphRequest WatchRequest(const MappingClientOptions& options) {
  v1::WatchGraphRequest request;
  request.set_map(options.map);
  request.mutable_options()->set_max_nodes(options.max_nodes);
  request.mutable_options()->set_encoding(options.compact ? v1::GRAPH_ENCODING_COMPACT
                                                          : v1::GRAPH_ENCODING_PLAIN);
  if (!options.whole_map) request.mutable_options()->set_robot(options.mission.robot);
  return request;
}

// Threads: the host's own call in; `host_` calls the host; `submaps_`, `loop_closures_` and
// `graphs_` each follow one stream. gRPC's callback threads only set flags for these.
class GrpcMappingClient final : public MappingClient {
 public:
  GrpcMappingClient(MappingClientOptions options, HostEstimator* host)
      : options_(std::move(options)),
        logger_(options_.log),
        stub_(v1::MappingService::NewStub(CreateChannel(options_))),
        outbox_(options_.outbox_capacity_bytes),
        host_(options_.mission, options_.synchronization, options_.min_time_between_comparisons,
              host, logger_),
        submaps_(
            stub_.get(), options_.map, options_.mission, NewBackoff(), &outbox_, &counters_,
            logger_,
            [this](int64_t sequence, const absl::Status& reason) {
              OnSubmapRefused(sequence, reason);
            },
            [this] { TellDroppedClouds(); }),
        loop_closures_(stub_.get(), NewBackoff(), &outbox_, &counters_, logger_,
                       [this](const absl::Status& reason) { OnLoopClosuresRefused(reason); }),
        graphs_(stub_.get(), WatchRequest(options_), NewBackoff(), options_.stale_after, &counters_,
                logger_,
                {[this](std::shared_ptr<const MapGraph> graph) { host_.OnGraph(std::move(graph)); },
                 [this](LinkState state) { host_.OnLinkState(state); }}) {}

  absl::Status AddSubmap(const Submap& submap) override {
    return GuardExceptions("AddSubmap", [&] { return TakeSubmap(submap); });
  }

  absl::Status AddLoopClosures(const std::vector<LoopClosure>& closures) override {
    return GuardExceptions("AddLoopClosures", [&] { return TakeLoopClosures(closures); });
  }

  absl::Status WaitUntilAcknowledged(absl::Duration timeout) override {
    const bool empty = outbox_.AwaitEmpty(timeout);
    absl::MutexLock lock(&mutex_);
    RETURN_IF_ERROR(std::exchange(first_refusal_, absl::OkStatus()));
    if (empty) return absl::OkStatus();
    const OutboxLevel level = outbox_.Level();
    return absl::DeadlineExceededError(absl::StrCat(
        level.submaps, " submaps, ", level.blobs, " clouds and ", level.loop_closure_batches,
        " batches of loop closures still wait for ", options_.server));
  }

  absl::Status WaitForKeyframe(int64_t index, uint64_t min_revision,
                               absl::Duration timeout) override {
    return host_.WaitForKeyframe(index, min_revision, timeout);
  }

  std::shared_ptr<const MapGraph> Graph() const override { return host_.Graph(); }

  absl::StatusOr<SynchronizationReport> Synchronize() override {
    return GuardExceptions("Synchronize", [&] { return host_.Synchronize(); });
  }

  MappingClientStats Stats() const override {
    const OutboxLevel level = outbox_.Level();
    const std::shared_ptr<const MapGraph> graph = host_.Graph();
    MappingClientStats stats;
    stats.link_state = host_.link_state();
    stats.submaps_acknowledged = level.submaps_acknowledged;
    stats.submaps_waiting = level.submaps;
    stats.blobs_waiting = level.blobs;
    stats.bytes_waiting = level.bytes;
    stats.bytes_sent = counters_.bytes_sent;
    stats.bytes_received = counters_.bytes_received;
    stats.reconnects = counters_.reconnects;
    stats.clouds_dropped = level.clouds_dropped;
    stats.revision = graph == nullptr ? 0 : graph->revision;
    stats.comparisons = host_.comparisons();
    return stats;
  }

 private:
  Backoff NewBackoff() const { return Backoff(options_.initial_backoff, options_.max_backoff); }

  absl::Status TakeSubmap(const Submap& submap) {
    v1::Submap message = ToProto(submap);
    ASSIGN_OR_RETURN(std::vector<WaitingBlob> blobs,
                     EncodeClouds(submap, options_.clouds, message));
    // The server's own checks, so that it will not refuse later what can be refused now.
    RETURN_IF_ERROR(FromProto(message, options_.mission).status());
    auto bytes = std::make_shared<const std::string>(message.SerializeAsString());
    if (bytes->size() > limits::kMaxSubmapBytes) {
      return absl::InvalidArgumentError(absl::StrCat("submap: ", bytes->size(),
                                                     " bytes serialised, at most ",
                                                     limits::kMaxSubmapBytes, "; make it shorter"));
    }
    {
      absl::MutexLock lock(&mutex_);
      RETURN_IF_ERROR(sequence_.Check(submap));
      RETURN_IF_ERROR(outbox_.PushSubmap({submap.sequence, submap.first_index, std::move(bytes)},
                                         std::move(blobs)));
      sequence_.Advance(submap);
    }
    submaps_.Notify();
    TellDroppedClouds();
    return absl::OkStatus();
  }

  // A server with access rules would refuse the batch, again and again.
  absl::Status CheckOwn(const LoopClosure& closure, int i) const {
    const std::string& robot = options_.mission.robot;
    if (!options_.tls.enabled() || closure.from.mission.robot == robot ||
        closure.to.mission.robot == robot) {
      return absl::OkStatus();
    }
    return absl::InvalidArgumentError(
        absl::StrCat("loop_closures[", i, "]: neither end is of robot '", robot, "'"));
  }

  absl::Status TakeLoopClosures(const std::vector<LoopClosure>& closures) {
    if (closures.empty()) return absl::OkStatus();
    if (closures.size() > limits::kMaxLoopClosuresPerRequest) {
      return absl::InvalidArgumentError(
          absl::StrCat("loop_closures: ", closures.size(), ", at most ",
                       limits::kMaxLoopClosuresPerRequest, " in one call"));
    }
    v1::AddLoopClosuresRequest request;
    request.set_map(options_.map);
    for (int i = 0; i < closures.size(); ++i) {
      v1::LoopClosure& message = *request.add_loop_closures() = ToProto(closures[i]);
      RETURN_IF_ERROR(AtField("loop_closures", i, FromProto(message)).status());
      RETURN_IF_ERROR(CheckOwn(closures[i], i));
    }
    RETURN_IF_ERROR(
        outbox_.PushLoopClosures(std::make_shared<const std::string>(request.SerializeAsString())));
    loop_closures_.Notify();
    TellDroppedClouds();
    return absl::OkStatus();
  }

  // The submap goes, and what follows it cannot be stored without it: the host may hand over a
  // better one under the same sequence. Not so for AlreadyExists: the server holds that sequence
  // with other content, and its next Ready is beyond it.
  void OnSubmapRefused(int64_t sequence, const absl::Status& reason) {
    std::vector<WaitingSubmap> dropped;
    {
      absl::MutexLock lock(&mutex_);
      if (first_refusal_.ok()) first_refusal_ = reason;
      if (!absl::IsAlreadyExists(reason)) dropped = outbox_.RemoveSubmapsFrom(sequence);
      if (!dropped.empty()) sequence_.Rewind(sequence, dropped.front().first_index);
    }
    TellRejected(sequence, reason);
    const absl::Status follows = absl::FailedPreconditionError(
        absl::StrCat("follows submap ", sequence, ", which was refused"));
    for (const WaitingSubmap& submap : dropped) {
      if (submap.sequence != sequence) TellRejected(submap.sequence, follows);
    }
  }

  void TellRejected(int64_t sequence, const absl::Status& reason) {
    logger_.Error("submap ", sequence, " refused for good: ", reason.ToString());
    host_.Post(
        [sequence, reason](HostEstimator& host) { host.OnSubmapRejected(sequence, reason); });
  }

  void TellDroppedClouds() {
    absl::MutexLock lock(&mutex_);
    const int64_t total = outbox_.Level().clouds_dropped;
    if (total == clouds_told_dropped_) return;
    clouds_told_dropped_ = total;
    host_.Post([total](HostEstimator& host) { host.OnCloudsDropped(total); });
  }

  void OnLoopClosuresRefused(const absl::Status& reason) {
    logger_.Error("loop closures refused for good: ", reason.ToString());
    {
      absl::MutexLock lock(&mutex_);
      if (first_refusal_.ok()) first_refusal_ = reason;
    }
    host_.Post([reason](HostEstimator& host) { host.OnLoopClosuresRejected(reason); });
  }

  const MappingClientOptions options_;
  const Logger logger_;
  TrafficCounters counters_;
  absl::Mutex mutex_;  // makes checking, pushing and advancing one step
  SubmapSequence sequence_ ABSL_GUARDED_BY(mutex_);
  absl::Status first_refusal_ ABSL_GUARDED_BY(mutex_);
  int64_t clouds_told_dropped_ ABSL_GUARDED_BY(mutex_) = 0;
  const std::unique_ptr<v1::MappingService::Stub> stub_;
  InMemoryOutbox outbox_;
  // Stopped from the last to the first: nothing calls host_ any more when it goes.
  HostThread host_;
  SubmapUploader submaps_;
  LoopClosureUploader loop_closures_;
  GraphSubscriber graphs_;
};

}  // namespace

absl::StatusOr<std::unique_ptr<MappingClient>> MappingClient::Create(MappingClientOptions options,
                                                                     HostEstimator* host) {
  if (host == nullptr) return absl::InvalidArgumentError("host: null");
  return GuardExceptions("MappingClient::Create",
                         [&]() -> absl::StatusOr<std::unique_ptr<MappingClient>> {
                           RETURN_IF_ERROR(options.Validate());
                           RETURN_IF_ERROR(AtField("tls", CheckFiles(options.tls)));
                           return std::make_unique<GrpcMappingClient>(std::move(options), host);
                         });
}

}  // namespace overtone
