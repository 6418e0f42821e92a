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
                               Logger logger, RefusalHandler on_refusal, DropHandler on_drop)
    : stub_(stub),
      backoff_(std::move(backoff)),
      outbox_(outbox),
      counters_(counters),
      logger_(std::move(logger)),
      on_refusal_(std::move(on_refusal)),
      on_drop_(std::move(on_drop)) {
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
    if (IsAccessRefused(status.code())) {
      logger_.Error("upload refused: ", status.ToString(), "; again in ",
                    absl::FormatDuration(delay));
    } else {
      logger_.Warning("upload interrupted: ", status.ToString(), "; again in ",
                      absl::FormatDuration(delay));
    }
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
  Progress progress{SubmapSender(outbox_), BlobSender(outbox_)};
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
  Notify();  // whatever it says, there may be more to send now
  switch (response.frame_case()) {
    case v1::UploadSubmapsResponse::kReady:
      logger_.Info("upload ready, the server expects submap ", response.ready().next_sequence());
      return progress.submaps.OnReady(response.ready());
    case v1::UploadSubmapsResponse::kAck:
      RETURN_IF_ERROR(progress.submaps.OnAck(response.ack()));
      backoff_.Reset();
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
    on_refusal_(reject.sequence(), reason);
  }
  return absl::Status(reason.code(),
                      absl::StrCat("submap ", reject.sequence(), " refused: ", reason.message()));
}

absl::Status SubmapUploader::HandleBlobResult(const v1::UploadBlobResult& result,
                                              Progress& progress) {
  RETURN_IF_ERROR(progress.blobs.OnResult(result));
  if (result.code() == 0) {
    backoff_.Reset();
  } else {
    logger_.Warning("the server did not take a cloud: ", result.message());
    on_drop_();
  }
  return absl::OkStatus();
}

absl::Status SubmapUploader::SendNext(UploadStream& stream, Progress& progress) {
  {
    // Before looking, so that a submap pushed while we look is not overlooked.
    absl::MutexLock lock(&mutex_);
    may_send_ = false;
  }
  ASSIGN_OR_RETURN(std::optional<v1::UploadSubmapsRequest> request,
                   progress.submaps.Next(progress.blobs.bytes_in_flight()));
  if (!request) request = progress.blobs.Next(progress.submaps.window_bytes());
  if (!request) return absl::OkStatus();
  counters_->bytes_sent += request->ByteSizeLong();
  stream.Write(*std::move(request));
  Notify();  // there may be more
  return absl::OkStatus();
}

}  // namespace overtone
