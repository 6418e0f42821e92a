// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/graph_subscriber.h"

#include <algorithm>
#include <string>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/client/internal/exception_guard.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/graph_conversion.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {
namespace {

// What a server that closes an old connection needs to take the next one.
constexpr std::chrono::seconds kQuietTime(1);

}  // namespace

GraphSubscriber::GraphSubscriber(v1::MappingService::Stub* stub, v1::WatchGraphRequest request,
                                 Backoff backoff, absl::Duration stale_after,
                                 TrafficCounters* counters, Logger logger, Listener listener)
    : stub_(stub),
      request_(std::move(request)),
      backoff_(std::move(backoff)),
      stale_after_(absl::ToChronoNanoseconds(stale_after)),
      counters_(counters),
      logger_(std::move(logger)),
      listener_(std::move(listener)) {
  thread_ = std::thread([this] { Run(); });
}

GraphSubscriber::~GraphSubscriber() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
  }
  thread_.join();
}

void GraphSubscriber::Run() {
  while (true) {
    const absl::Status status = GuardExceptions("graph stream", [this] { return RunStream(); });
    {
      absl::MutexLock lock(&mutex_);
      if (stopping_) return;
    }
    if (quiet_restart_.Allows(heard_on_this_stream_, status, Clock::now())) {
      if (link_state_ == LinkState::kLive) connecting_at_ = Clock::now() + kQuietTime;
      continue;
    }
    const absl::Duration delay = backoff_.Next();
    OnInterrupted(status, delay);
    if (Await(absl::Condition(&stopping_), Clock::now() + absl::ToChronoNanoseconds(delay))) return;
  }
}

void GraphSubscriber::OnInterrupted(const absl::Status& status, absl::Duration delay) {
  const std::string again = absl::StrCat("; again in ", absl::FormatDuration(delay));
  if (IsAccessRefused(status.code())) {
    logger_.Error("the server refuses us: ", status.ToString(), again);
    last_heard_ = Clock::now();  // it did answer
    SetLinkState(LinkState::kRefused);
    return;
  }
  logger_.Warning("graph stream interrupted: ", status.ToString(), again);
  if (link_state_ != LinkState::kStale) SetLinkState(LinkState::kConnecting);
}

absl::Status GraphSubscriber::RunStream() {
  heard_on_this_stream_ = false;
  request_.set_after_revision(resumable_ ? graph_->revision : 0);
  request_.set_map_epoch(resumable_ ? graph_->map_epoch : 0);
  counters_->bytes_sent += request_.ByteSizeLong();
  WatchStream stream(&mutex_);
  stub_->async()->WatchGraph(&stream.context(), &request_, &stream);
  stream.Start();
  const absl::Status status = GuardExceptions("graph stream", [&] { return HandleFrames(stream); });
  const grpc::Status end = stream.Finish();
  if (!status.ok()) return status;
  return end.ok() ? absl::UnavailableError("the server ended the stream") : FromGrpcStatus(end);
}

// Ok: the stream ended, or we are to stop. Anything else: we end it.
absl::Status GraphSubscriber::HandleFrames(WatchStream& stream) {
  const auto something_happened = [&] {
    mutex_.AssertHeld();
    return stopping_ || stream.HasMessage() || stream.Ended();
  };
  while (true) {
    if (!Await(absl::Condition(&something_happened), Clock::now() + stale_after_)) {
      return absl::DeadlineExceededError("silence");
    }
    {
      absl::MutexLock lock(&mutex_);
      if (stopping_ || !stream.HasMessage()) return absl::OkStatus();
    }
    const v1::WatchGraphResponse frame = stream.Take();
    counters_->bytes_received += frame.ByteSizeLong();
    last_heard_ = Clock::now();
    connecting_at_ = Clock::time_point::max();
    if (!heard_on_this_stream_ && std::exchange(heard_before_, true)) ++counters_->reconnects;
    heard_on_this_stream_ = true;
    SetLinkState(LinkState::kLive);
    listener_.on_heard();
    RETURN_IF_ERROR(Handle(frame));
    backoff_.Reset();
  }
}

absl::Status GraphSubscriber::Handle(const v1::WatchGraphResponse& frame) {
  absl::Status status;
  switch (frame.frame_case()) {
    case v1::WatchGraphResponse::kSnapshot:
      status = HandleSnapshot(frame.snapshot());
      break;
    case v1::WatchGraphResponse::kDelta:
      status = HandleDelta(frame.delta());
      break;
    case v1::WatchGraphResponse::kHeartbeat:
    case v1::WatchGraphResponse::FRAME_NOT_SET:  // a frame of a newer protocol
      break;
  }
  if (!status.ok()) resumable_ = false;
  return status;
}

absl::Status GraphSubscriber::HandleSnapshot(const v1::Graph& snapshot) {
  ASSIGN_OR_RETURN(MapGraph graph, FromProto(snapshot));
  Hold(std::move(graph));
  return absl::OkStatus();
}

absl::Status GraphSubscriber::HandleDelta(const v1::GraphDelta& delta) {
  if (!resumable_) return absl::FailedPreconditionError("a delta before the first snapshot");
  ASSIGN_OR_RETURN(MapGraph graph, ApplyDelta(*graph_, delta));
  Hold(std::move(graph));
  return absl::OkStatus();
}

// Takes the graph as the base of further deltas, and passes it on if it is newer than what the
// listener has.
void GraphSubscriber::Hold(MapGraph graph) {
  const bool newer = graph_ == nullptr || graph.map_epoch != graph_->map_epoch ||
                     graph.revision > graph_->revision;
  if (resumable_ && !newer) return;
  graph_ = std::make_shared<const MapGraph>(std::move(graph));
  resumable_ = true;
  if (newer && graph_->revision > 0) listener_.on_graph(graph_);
}

void GraphSubscriber::SetLinkState(LinkState state) {
  if (std::exchange(link_state_, state) != state) listener_.on_link_state(state);
}

// When something will be overdue that is not yet; max: nothing.
GraphSubscriber::Clock::time_point GraphSubscriber::TellOverdue(Clock::time_point now) {
  const Clock::time_point stale_at = last_heard_ + stale_after_;
  if (now >= stale_at) {
    SetLinkState(LinkState::kStale);
    return Clock::time_point::max();
  }
  if (now >= connecting_at_) {
    connecting_at_ = Clock::time_point::max();
    SetLinkState(LinkState::kConnecting);
  }
  return std::min(stale_at, connecting_at_);
}

bool GraphSubscriber::Await(const absl::Condition& condition, Clock::time_point deadline) {
  while (true) {
    const Clock::time_point now = Clock::now();
    const Clock::time_point wake = std::min(deadline, TellOverdue(now));
    {
      absl::MutexLock lock(&mutex_);
      if (mutex_.AwaitWithTimeout(condition, absl::FromChrono(wake - now))) return true;
    }
    if (now >= deadline) return false;
  }
}

}  // namespace overtone
