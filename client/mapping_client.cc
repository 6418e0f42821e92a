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
#include "overtone/client/internal/clock_probe.h"
#include "overtone/client/internal/cloud_encoding.h"
#include "overtone/client/internal/exception_guard.h"
#include "overtone/client/internal/graph_subscriber.h"
#include "overtone/client/internal/host_thread.h"
#include "overtone/client/internal/leftover_missions.h"
#include "overtone/client/internal/logger.h"
#include "overtone/client/internal/loop_closure_uploader.h"
#include "overtone/client/internal/outbox_directory.h"
#include "overtone/client/internal/report_messages.h"
#include "overtone/client/internal/status_reporter.h"
#include "overtone/client/internal/submap_intake.h"
#include "overtone/client/internal/submap_outbox.h"
#include "overtone/client/internal/submap_sequence.h"
#include "overtone/client/internal/submap_uploader.h"
#include "overtone/client/internal/token_bucket.h"
#include "overtone/client/internal/traffic_counters.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/proto/conversion/submap_conversion.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {
namespace {

// As SubmapUploader::Settings says.
constexpr absl::Duration kStallTimeout = absl::Minutes(5);

v1::WatchGraphRequest WatchRequest(const MappingClientOptions& options) {
  v1::WatchGraphRequest request;
  request.set_map(options.map);
  request.mutable_options()->set_max_nodes(options.max_nodes);
  request.mutable_options()->set_encoding(options.compact ? v1::GRAPH_ENCODING_COMPACT
                                                          : v1::GRAPH_ENCODING_PLAIN);
  if (!options.whole_map) request.mutable_options()->set_robot(options.mission.robot);
  return request;
}

StatusReporter::Settings ReporterSettings(const MappingClientOptions& options) {
  StatusReporter::Settings settings;
  settings.map = options.map;
  settings.mission = options.mission;
  settings.interval = options.report_interval;
  settings.max_upload_bytes_per_s = options.max_upload_bytes_per_s;
  return settings;
}

// Threads: the host's own call in; `intake_` fills the outbox; `host_` calls the host; `submaps_`,
// `loop_closures_` and `graphs_` each follow one stream; `reporter_` asks all of them. gRPC's
// callback threads only set flags for these.
class GrpcMappingClient final : public MappingClient {
 public:
  GrpcMappingClient(MappingClientOptions options, std::unique_ptr<SubmapOutbox> outbox,
                    HostEstimator* host)
      : options_(std::move(options)),
        logger_(options_.log),
        bucket_(options_.max_upload_bytes_per_s),
        stub_(v1::MappingService::NewStub(CreateChannel(options_))),
        outbox_(std::move(outbox)),
        reporter_(
            stub_.get(), ReporterSettings(options_), [this] { return ToProto(Stats()); },
            &counters_, &bucket_, logger_),
        host_(options_.mission, options_.synchronization, options_.min_time_between_comparisons,
              host, logger_, OnComparison()),
        clock_(stub_.get(), options_.clock_offset_warning, &counters_, logger_),
        intake_(outbox_.get(), options_.clouds, options_.outbox_sync_interval, logger_,
                [this] { OnStored(); }),
        submaps_(stub_.get(),
                 {options_.map, options_.mission, NewBackoff(), kStallTimeout, &bucket_},
                 outbox_.get(), &counters_, logger_,
                 {[this](int64_t sequence, const absl::Status& reason) {
                    OnSubmapRefused(sequence, reason);
                  },
                  [this] { TellDroppedClouds(); },
                  [this](int64_t first_waiting, const absl::Status& reason) {
                    OnGap(first_waiting, reason);
                  }}),
        loop_closures_(
            stub_.get(), NewBackoff(), outbox_.get(), &counters_, logger_,
            [this](const absl::Status& reason) { OnLoopClosuresRefused(reason); }, &bucket_),
        graphs_(
            stub_.get(), WatchRequest(options_), NewBackoff(), options_.stale_after, &counters_,
            logger_,
            {[this](std::shared_ptr<const MapGraph> graph) { host_.OnGraph(std::move(graph)); },
             [this](LinkState state) { host_.OnLinkState(state); }, [this] { clock_.OnHeard(); }}),
        leftovers_(stub_.get(), options_, &counters_, &bucket_, logger_) {
    {
      absl::MutexLock lock(&mutex_);
      sequence_.MoveTo(outbox_->Position());
    }
    intake_.Start();
    if (options_.report_status) reporter_.Start();
  }

  // First what tells of others, or asks them, while they are still there.
  ~GrpcMappingClient() override {
    reporter_.Stop();
    intake_.Stop();
  }

  SubmapPosition NextSubmap() const override {
    absl::MutexLock lock(&mutex_);
    return {sequence_.sequence(), sequence_.first_index()};
  }

  absl::Status AddSubmap(const Submap& submap) override {
    return GuardExceptions("AddSubmap", [&] { return TakeSubmap(submap); });
  }

  absl::Status AddLoopClosures(const std::vector<LoopClosure>& closures) override {
    return GuardExceptions("AddLoopClosures", [&] { return TakeLoopClosures(closures); });
  }

  absl::Status WaitUntilPersisted(absl::Duration timeout) override {
    if (intake_.AwaitStored(timeout)) return absl::OkStatus();
    return absl::DeadlineExceededError(
        absl::StrCat("not on disk after ", absl::FormatDuration(timeout)));
  }

  absl::Status WaitUntilAcknowledged(absl::Duration timeout) override {
    const bool empty = outbox_->AwaitEmpty(timeout);
    absl::MutexLock lock(&mutex_);
    RETURN_IF_ERROR(std::exchange(first_refusal_, absl::OkStatus()));
    if (empty) return absl::OkStatus();
    const OutboxLevel level = outbox_->Level();
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
    const OutboxLevel level = outbox_->Level();
    const std::shared_ptr<const MapGraph> graph = host_.Graph();
    MappingClientStats stats;
    stats.link_state = host_.link_state();
    stats.submaps_acknowledged = level.submaps_acknowledged;
    stats.submaps_waiting = level.submaps;
    stats.blobs_waiting = level.blobs + intake_.clouds_waiting();
    stats.bytes_waiting = level.bytes;
    stats.bytes_sent = counters_.bytes_sent;
    stats.bytes_received = counters_.bytes_received;
    stats.report_bytes_sent = counters_.report_bytes_sent;
    stats.reconnects = counters_.reconnects;
    stats.clouds_dropped = level.clouds_dropped;
    stats.persisted_through = level.saved_through;
    stats.synced_through = level.synced_through;
    stats.missions_waiting = leftovers_.waiting();
    if (const auto offset = clock_.Offset()) {
      stats.clock_offset_s = absl::ToDoubleSeconds(offset->offset);
      stats.clock_offset_uncertainty_s = absl::ToDoubleSeconds(offset->uncertainty);
    }
    stats.outbox_on_disk = outbox_->HasFile() && level.disk_ok;
    stats.revision = graph == nullptr ? 0 : graph->revision;
    stats.comparisons = host_.comparisons();
    return stats;
  }

 private:
  HostThread::ComparisonHandler OnComparison() {
    if (!options_.report_status) return nullptr;
    return [this](const SynchronizationReport& report) { reporter_.OnComparison(report); };
  }

  Backoff NewBackoff() const { return Backoff(options_.initial_backoff, options_.max_backoff); }

  absl::Status TakeSubmap(const Submap& submap) {
    v1::Submap message = ToProto(submap);
    RETURN_IF_ERROR(AnnounceClouds(submap, message));
    // The server's own checks, so that it will not refuse later what can be refused now.
    RETURN_IF_ERROR(FromProto(message, options_.mission).status());
    const int64_t bytes = static_cast<int64_t>(message.ByteSizeLong());
    if (bytes > limits::kMaxSubmapBytes) {
      return absl::InvalidArgumentError(absl::StrCat("submap: ", bytes,
                                                     " bytes serialised, at most ",
                                                     limits::kMaxSubmapBytes, "; make it shorter"));
    }
    {
      absl::MutexLock lock(&mutex_);
      RETURN_IF_ERROR(sequence_.Check(submap));
      RETURN_IF_ERROR(outbox_->Reserve(bytes));
      intake_.Push(std::move(message), submap.clouds, bytes);
      sequence_.Advance(submap);
    }
    host_.AddKeyframes(submap.first_index, submap.keyframes);
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

  // From the intake's thread: the outbox has changed.
  void OnStored() {
    submaps_.Notify();
    loop_closures_.Notify();
    TellDroppedClouds();
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
    RETURN_IF_ERROR(outbox_->PushLoopClosures(
        std::make_shared<const std::string>(request.SerializeAsString())));
    intake_.Notify();
    TellDroppedClouds();
    return absl::OkStatus();
  }

  // The submap goes, and what follows it cannot be stored without it: the host may hand over a
  // better one under the same sequence. Not so for AlreadyExists: the server holds that sequence
  // with other content, and its next Ready is beyond it.
  void OnSubmapRefused(int64_t sequence, const absl::Status& reason) {
    std::vector<int64_t> follow;
    {
      absl::MutexLock lock(&mutex_);
      if (first_refusal_.ok()) first_refusal_ = reason;
      if (!absl::IsAlreadyExists(reason)) follow = DropFrom(sequence);
    }
    TellRejected(sequence, reason);
    const absl::Status follows = absl::FailedPreconditionError(
        absl::StrCat("follows submap ", sequence, ", which was refused"));
    for (const int64_t later : follow) {
      if (later != sequence) TellRejected(later, follows);
    }
    intake_.Notify();  // the file changes too
  }

  // From the outbox and from what is still on the way to it; in order.
  std::vector<int64_t> DropFrom(int64_t sequence) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    const std::vector<int64_t> on_the_way = intake_.DropFrom(sequence);
    std::vector<int64_t> dropped;
    for (const SubmapHead& submap : outbox_->RemoveSubmapsFrom(sequence)) {
      dropped.push_back(submap.sequence);
    }
    dropped.insert(dropped.end(), on_the_way.begin(), on_the_way.end());
    if (!dropped.empty()) sequence_.MoveTo(outbox_->Position());
    return dropped;
  }

  void OnGap(int64_t first_waiting, const absl::Status& reason) {
    {
      absl::MutexLock lock(&mutex_);
      if (first_refusal_.ok()) first_refusal_ = reason;
    }
    host_.Post([first_waiting, reason](HostEstimator& host) {
      host.OnSubmapRejected(first_waiting, reason);
    });
  }

  void TellRejected(int64_t sequence, const absl::Status& reason) {
    logger_.Error("submap ", sequence, " refused for good: ", reason.ToString());
    host_.Post(
        [sequence, reason](HostEstimator& host) { host.OnSubmapRejected(sequence, reason); });
  }

  void TellDroppedClouds() {
    absl::MutexLock lock(&mutex_);
    const int64_t total = outbox_->Position().clouds_dropped;
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
  TokenBucket bucket_;
  mutable absl::Mutex mutex_;  // makes checking, handing over and advancing one step
  SubmapSequence sequence_ ABSL_GUARDED_BY(mutex_);
  absl::Status first_refusal_ ABSL_GUARDED_BY(mutex_);
  int64_t clouds_told_dropped_ ABSL_GUARDED_BY(mutex_) = 0;
  const std::unique_ptr<v1::MappingService::Stub> stub_;
  const std::unique_ptr<SubmapOutbox> outbox_;
  StatusReporter reporter_;  // called by host_
  // Stopped from the last to the first: nothing calls host_ any more when it goes.
  HostThread host_;
  ClockProbe clock_;
  SubmapIntake intake_;
  SubmapUploader submaps_;
  LoopClosureUploader loop_closures_;
  GraphSubscriber graphs_;
  LeftoverMissions leftovers_;
};

absl::StatusOr<std::unique_ptr<SubmapOutbox>> OpenMissionOutbox(
    const MappingClientOptions& options) {
  if (options.outbox_dir.empty()) {
    return std::make_unique<SubmapOutbox>(options.outbox_capacity_bytes);
  }
  RETURN_IF_ERROR(CreateOutboxDirectory(options.outbox_dir));
  const std::string path = OutboxPath(options.outbox_dir, options.map, options.mission);
  absl::StatusOr<std::unique_ptr<SubmapOutbox>> outbox =
      SubmapOutbox::Open(options.outbox_capacity_bytes, path, Logger(options.log));
  if (outbox.ok()) return outbox;
  const bool in_use = absl::IsUnavailable(outbox.status());
  return absl::FailedPreconditionError(absl::StrCat(
      "outbox_dir: ", path, ": ", in_use ? "in use by another client" : outbox.status().message()));
}

}  // namespace

absl::StatusOr<std::unique_ptr<MappingClient>> MappingClient::Create(MappingClientOptions options,
                                                                     HostEstimator* host) {
  if (host == nullptr) return absl::InvalidArgumentError("host: null");
  return GuardExceptions(
      "MappingClient::Create", [&]() -> absl::StatusOr<std::unique_ptr<MappingClient>> {
        RETURN_IF_ERROR(options.Validate());
        RETURN_IF_ERROR(AtField("tls", CheckFiles(options.tls)));
        ASSIGN_OR_RETURN(std::unique_ptr<SubmapOutbox> outbox, OpenMissionOutbox(options));
        return std::make_unique<GrpcMappingClient>(std::move(options), std::move(outbox), host);
      });
}

}  // namespace overtone
