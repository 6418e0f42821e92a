// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/submap_uploader.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/client/internal/exception_guard.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/limits.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {

SubmapUploader::SubmapUploader(v1::MappingService::Stub* stub, Settings settings,
                               SubmapOutbox* outbox, TrafficCounters* counters, Logger logger,
                               Listener listener)
    : stub_(stub),
      settings_(std::move(settings)),
      outbox_(outbox),
      counters_(counters),
      logger_(std::move(logger)),
      listener_(std::move(listener)) {
  header_.set_map(settings_.map);
  header_.mutable_mission()->set_robot(settings_.mission.robot);
  header_.mutable_mission()->set_mission(settings_.mission.mission);
  thread_ = std::thread([this] { Run(); });
}

SubmapUploader::~SubmapUploader() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
  }
  thread_.join();
}

void SubmapUploader::Notify() {
  absl::MutexLock lock(&mutex_);
  may_send_ = true;
}

void SubmapUploader::Run() {
  while (true) {
    const absl::Status status = GuardExceptions("upload", [this] { return RunStream(); });
    {
      absl::MutexLock lock(&mutex_);
      if (stopping_) return;
    }
    if (quiet_restart_.Allows(heard_, status, Clock::now())) continue;
    const absl::Duration delay = DelayAfter(status);
    absl::MutexLock lock(&mutex_);
    if (mutex_.AwaitWithTimeout(absl::Condition(&stopping_), delay)) return;
  }
}

absl::Duration SubmapUploader::DelayAfter(const absl::Status& status) {
  // Nothing that trying again soon would mend.
  const bool gap = absl::IsDataLoss(status);
  const bool refused = IsAccessRefused(status.code());
  const absl::Duration delay =
      gap || refused ? settings_.backoff.Longest() : settings_.backoff.Next();
  if (gap && std::exchange(gap_told_, true)) return delay;
  if (refused) {
    logger_.Error("upload refused: ", status.ToString(), "; again in ",
                  absl::FormatDuration(delay));
  } else {
    logger_.Warning("upload interrupted: ", status.ToString(), "; again in ",
                    absl::FormatDuration(delay));
  }
  if (gap) {
    const std::optional<SubmapHead> waiting = outbox_->FirstSubmapFrom(0);
    listener_.on_gap(waiting ? waiting->sequence : outbox_->LastSequence() + 1, status);
  }
  return delay;
}

absl::Status SubmapUploader::RunStream() {
  heard_ = false;
  UploadSubmapsStream stream(&mutex_);
  stub_->async()->UploadSubmaps(&stream.context(), &stream);
  v1::UploadSubmapsRequest header;
  *header.mutable_header() = header_;
  Count(static_cast<int64_t>(header.ByteSizeLong()));
  stream.Write(std::move(header));
  stream.Start();
  const absl::Status status = GuardExceptions("upload", [&] { return HandleEvents(stream); });
  const grpc::Status end = stream.Finish();
  if (!status.ok()) return status;
  return end.ok() ? absl::UnavailableError("the server ended the stream") : FromGrpcStatus(end);
}

// Ok: the stream ended, or we are to stop. Anything else: we end it.
absl::Status SubmapUploader::HandleEvents(UploadSubmapsStream& stream) {
  Progress progress{SubmapSender(outbox_), BlobSender(outbox_)};
  while (true) {
    switch (AwaitEvent(stream, progress)) {
      case Event::kStop:
      case Event::kEnded:
        return absl::OkStatus();
      case Event::kMessage:
        heard_ = true;
        progress.last_move = Clock::now();
        RETURN_IF_ERROR(Handle(stream.Take(), progress));
        break;
      case Event::kCanSend:
        RETURN_IF_ERROR(SendNext(stream, progress));
        break;
      case Event::kStalled:
        return absl::DeadlineExceededError("the server does not answer");
    }
  }
}

SubmapUploader::Event SubmapUploader::AwaitEvent(const UploadSubmapsStream& stream,
                                                 const Progress& progress) {
  const Clock::time_point stalled_at =
      progress.AwaitsAnswer()
          ? progress.last_move + absl::ToChronoNanoseconds(settings_.stall_timeout)
          : Clock::time_point::max();
  bool affordable = false;
  const auto next_event = [&]() -> std::optional<Event> {
    mutex_.AssertHeld();
    if (stopping_) return Event::kStop;
    if (stream.HasMessage()) return Event::kMessage;
    if (stream.Ended()) return Event::kEnded;
    if (affordable && stream.CanWrite() && may_send_) return Event::kCanSend;
    return std::nullopt;
  };
  const auto happened = [&] { return next_event().has_value(); };
  while (true) {
    const Clock::time_point now = Clock::now();
    if (now >= stalled_at) return Event::kStalled;
    Clock::time_point wake = stalled_at;
    if (settings_.bucket != nullptr) {
      const Clock::time_point ready_at = settings_.bucket->ReadyAt(now);
      affordable = ready_at <= now;
      if (!affordable) wake = std::min(wake, ready_at);
    } else {
      affordable = true;
    }
    absl::MutexLock lock(&mutex_);
    if (wake == Clock::time_point::max()) {
      mutex_.Await(absl::Condition(&happened));
      return *next_event();
    }
    if (mutex_.AwaitWithTimeout(absl::Condition(&happened), absl::FromChrono(wake - now))) {
      return *next_event();
    }
  }
}

absl::Status SubmapUploader::Handle(const v1::UploadSubmapsResponse& response, Progress& progress) {
  counters_->bytes_received += response.ByteSizeLong();
  Notify();  // whatever it says, there may be more to send now
  switch (response.frame_case()) {
    case v1::UploadSubmapsResponse::kReady:
      logger_.Info("upload ready, the server expects submap ", response.ready().next_sequence());
      return progress.submaps.OnReady(response.ready());
    case v1::UploadSubmapsResponse::kAck:
      RETURN_IF_ERROR(progress.submaps.OnAck(response.ack()));
      settings_.backoff.Reset();
      return absl::OkStatus();
    case v1::UploadSubmapsResponse::kReject:
      return HandleReject(response.reject(), progress);
    case v1::UploadSubmapsResponse::kWant:
      return progress.blobs.OnWant(response.want(), progress.submaps.acknowledged_through());
    case v1::UploadSubmapsResponse::kBlobResult:
      return HandleBlobResult(response.blob_result(), progress);
    case v1::UploadSubmapsResponse::FRAME_NOT_SET:
      return absl::OkStatus();  // a frame of a newer protocol
  }
  return absl::OkStatus();
}

// Always ends the stream: what follows in flight would be refused as a gap. OutOfRange needs no
// more than that, since the next Ready says what the server expects.
absl::Status SubmapUploader::HandleReject(const v1::UploadReject& reject,
                                          const Progress& progress) {
  RETURN_IF_ERROR(progress.submaps.CheckReject(reject));
  const absl::Status reason(static_cast<absl::StatusCode>(reject.code()), reject.message());
  if (!IsRetryable(reason.code()) && !absl::IsOutOfRange(reason)) {
    listener_.on_refusal(reject.sequence(), reason);
  }
  return absl::Status(reason.code(),
                      absl::StrCat("submap ", reject.sequence(), " refused: ", reason.message()));
}

absl::Status SubmapUploader::HandleBlobResult(const v1::UploadBlobResult& result,
                                              Progress& progress) {
  RETURN_IF_ERROR(progress.blobs.OnResult(result));
  if (result.code() == 0) {
    settings_.backoff.Reset();
  } else {
    logger_.Warning("the server did not take a cloud: ", result.message());
    listener_.on_drop();
  }
  return absl::OkStatus();
}

absl::Status SubmapUploader::SendNext(UploadSubmapsStream& stream, Progress& progress) {
  {
    // Before looking, so that a submap pushed while we look is not overlooked.
    absl::MutexLock lock(&mutex_);
    may_send_ = false;
  }
  ASSIGN_OR_RETURN(std::optional<v1::UploadSubmapsRequest> request, NextRequest(progress));
  if (!request) return absl::OkStatus();
  progress.last_move = Clock::now();
  Count(static_cast<int64_t>(request->ByteSizeLong()));
  stream.Write(*std::move(request));
  Notify();  // there may be more
  return absl::OkStatus();
}

absl::StatusOr<std::optional<v1::UploadSubmapsRequest>> SubmapUploader::NextRequest(
    Progress& progress) {
  ASSIGN_OR_RETURN(std::optional<v1::UploadSubmapsRequest> submap,
                   progress.submaps.Next(progress.blobs.bytes_in_flight()));
  if (submap) {
    gap_told_ = false;
    return submap;
  }
  // On a slow link small chunks let a submap that comes in between wait for less.
  constexpr int64_t kMinChunkBytes = 4096;
  int64_t chunk_bytes = limits::kMaxBlobChunkBytes;
  if (settings_.bucket != nullptr && settings_.bucket->message_bytes() > 0) {
    chunk_bytes = std::clamp(settings_.bucket->message_bytes(), kMinChunkBytes, chunk_bytes);
  }
  return progress.blobs.Next(progress.submaps.window_bytes(), chunk_bytes);
}

void SubmapUploader::Count(int64_t bytes) {
  counters_->bytes_sent += bytes;
  if (settings_.bucket != nullptr) settings_.bucket->Take(bytes, Clock::now());
}

}  // namespace overtone
