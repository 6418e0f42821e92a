// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/submap_uploader.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/client/internal/exception_guard.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {

SubmapUploader::SubmapUploader(v1::MappingService::Stub* stub, std::string map, MissionId mission,
                               Backoff backoff, SubmapOutbox* outbox, TrafficCounters* counters,
                               Logger logger, RefusalHandler on_refusal)
    : stub_(stub),
      backoff_(std::move(backoff)),
      outbox_(outbox),
      counters_(counters),
      logger_(std::move(logger)),
      on_refusal_(std::move(on_refusal)) {
  header_.set_map(std::move(map));
  header_.mutable_mission()->set_robot(std::move(mission.robot));
  header_.mutable_mission()->set_mission(std::move(mission.mission));
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
    const absl::Duration delay = backoff_.Next();
    absl::MutexLock lock(&mutex_);
    if (stopping_) return;
    logger_.Warning("upload interrupted: ", status.ToString(), "; again in ",
                    absl::FormatDuration(delay));
    if (mutex_.AwaitWithTimeout(absl::Condition(&stopping_), delay)) return;
  }
}

absl::Status SubmapUploader::RunStream() {
  UploadStream stream(&mutex_);
  stub_->async()->UploadSubmaps(&stream.context(), &stream);
  v1::UploadSubmapsRequest header;
  *header.mutable_header() = header_;
  counters_->bytes_sent += header.ByteSizeLong();
  stream.Write(std::move(header));
  stream.Start();
  const absl::Status status = GuardExceptions("upload", [&] { return HandleEvents(stream); });
  const grpc::Status end = stream.Finish();
  if (!status.ok()) return status;
  return end.ok() ? absl::UnavailableError("the server ended the stream") : FromGrpcStatus(end);
}

// Ok: the stream ended, or we are to stop. Anything else: we end it.
absl::Status SubmapUploader::HandleEvents(UploadStream& stream) {
  Progress progress;
  while (true) {
    switch (AwaitEvent(stream)) {
      case Event::kStop:
      case Event::kEnded:
        return absl::OkStatus();
      case Event::kMessage:
        RETURN_IF_ERROR(Handle(stream.Take(), progress));
        break;
      case Event::kCanSend:
        RETURN_IF_ERROR(SendNext(stream, progress));
        break;
    }
  }
}

SubmapUploader::Event SubmapUploader::AwaitEvent(const UploadStream& stream) {
  const auto next_event = [&]() -> std::optional<Event> {
    mutex_.AssertHeld();
    if (stopping_) return Event::kStop;
    if (stream.HasMessage()) return Event::kMessage;
    if (stream.Ended()) return Event::kEnded;
    if (stream.CanWrite() && may_send_) return Event::kCanSend;
    return std::nullopt;
  };
  const auto happened = [&] { return next_event().has_value(); };
  absl::MutexLock lock(&mutex_, absl::Condition(&happened));
  return *next_event();
}

absl::Status SubmapUploader::Handle(const v1::UploadSubmapsResponse& response, Progress& progress) {
  counters_->bytes_received += response.ByteSizeLong();
  switch (response.frame_case()) {
    case v1::UploadSubmapsResponse::kReady:
      return HandleReady(response.ready(), progress);
    case v1::UploadSubmapsResponse::kAck:
      return HandleAck(response.ack(), progress);
    case v1::UploadSubmapsResponse::kReject:
      return HandleReject(response.reject(), progress);
    case v1::UploadSubmapsResponse::FRAME_NOT_SET:
      return absl::OkStatus();  // a frame of a newer protocol
  }
  return absl::OkStatus();
}

absl::Status SubmapUploader::HandleReady(const v1::UploadReady& ready, Progress& progress) {
  if (progress.ready) return absl::InternalError("a second Ready on one stream");
  progress.ready = true;
  progress.next = ready.next_sequence();
  progress.window_bytes = ready.window_bytes();
  outbox_->RemoveSubmapsThrough(progress.next - 1);
  logger_.Info("upload ready, the server expects submap ", progress.next);
  Notify();
  return absl::OkStatus();
}

absl::Status SubmapUploader::HandleAck(const v1::UploadAck& ack, Progress& progress) {
  const int64_t sequence = ack.durable_through_sequence();
  if (!progress.ready || sequence >= progress.next) {
    return absl::InternalError(
        absl::StrCat("the server acknowledged submap ", sequence, ", which it was not sent"));
  }
  outbox_->RemoveSubmapsThrough(sequence);
  while (!progress.in_flight.empty() && progress.in_flight.front().first <= sequence) {
    progress.in_flight_bytes -= progress.in_flight.front().second;
    progress.in_flight.pop_front();
  }
  backoff_.Reset();
  Notify();  // the window has moved
  return absl::OkStatus();
}

// Always ends the stream: what follows in flight would be refused as a gap. OutOfRange needs no
// more than that, since the next Ready says what the server expects.
absl::Status SubmapUploader::HandleReject(const v1::UploadReject& reject,
                                          const Progress& progress) {
  const absl::Status reason(static_cast<absl::StatusCode>(reject.code()), reject.message());
  if (reason.ok() || !progress.ready || reject.sequence() >= progress.next) {
    return absl::InternalError(
        absl::StrCat("the server refused submap ", reject.sequence(), ", which it was not sent"));
  }
  if (!IsRetryable(reason.code()) && !absl::IsOutOfRange(reason)) {
    on_refusal_(reject.sequence(), reason);
  }
  return absl::Status(reason.code(),
                      absl::StrCat("submap ", reject.sequence(), " refused: ", reason.message()));
}

absl::Status SubmapUploader::SendNext(UploadStream& stream, Progress& progress) {
  {
    // Before looking, so that a submap pushed while we look is not overlooked.
    absl::MutexLock lock(&mutex_);
    may_send_ = false;
  }
  if (!progress.ready) return absl::OkStatus();
  // A host that started over with the same mission hands over again what the server already holds.
  outbox_->RemoveSubmapsThrough(progress.in_flight.empty() ? progress.next - 1
                                                           : progress.in_flight.front().first - 1);
  const std::optional<WaitingSubmap> submap = outbox_->FirstSubmapFrom(progress.next);
  if (!submap) return absl::OkStatus();
  if (submap->sequence != progress.next) {
    return absl::DataLossError(
        absl::StrCat("the server expects submap ", progress.next, ", but submaps before ",
                     submap->sequence, " were acknowledged and are gone; start a new mission"));
  }
  const int64_t bytes = static_cast<int64_t>(submap->bytes->size());
  const bool fits = progress.in_flight_bytes + bytes <= progress.window_bytes;
  if (!fits && !progress.in_flight.empty()) return absl::OkStatus();  // the next Ack notifies

  v1::UploadSubmapsRequest request;
  if (!request.mutable_submap()->ParseFromString(*submap->bytes)) {
    return absl::DataLossError(
        absl::StrCat("submap ", submap->sequence, " in the outbox is damaged"));
  }
  counters_->bytes_sent += request.ByteSizeLong();
  progress.in_flight.emplace_back(submap->sequence, bytes);
  progress.in_flight_bytes += bytes;
  ++progress.next;
  stream.Write(std::move(request));
  Notify();  // there may be more
  return absl::OkStatus();
}

}  // namespace overtone
