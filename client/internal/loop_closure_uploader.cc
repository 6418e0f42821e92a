// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/loop_closure_uploader.h"

#include <chrono>
#include <utility>

#include "absl/time/time.h"
#include "overtone/client/internal/exception_guard.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {
namespace {

constexpr absl::Duration kCallTimeout = absl::Seconds(10);

}  // namespace

LoopClosureUploader::LoopClosureUploader(v1::MappingService::Stub* stub, Backoff backoff,
                                         SubmapOutbox* outbox, TrafficCounters* counters,
                                         Logger logger, RefusalHandler on_refusal,
                                         TokenBucket* bucket)
    : stub_(stub),
      backoff_(std::move(backoff)),
      outbox_(outbox),
      counters_(counters),
      logger_(std::move(logger)),
      on_refusal_(std::move(on_refusal)),
      bucket_(bucket) {
  thread_ = std::thread([this] { Run(); });
}

LoopClosureUploader::~LoopClosureUploader() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
    if (call_ != nullptr) call_->TryCancel();
  }
  thread_.join();
}

void LoopClosureUploader::Notify() {
  absl::MutexLock lock(&mutex_);
  has_work_ = true;
}

void LoopClosureUploader::Run() {
  while (AwaitWork()) {
    const absl::Status status =
        GuardExceptions("loop closure upload", [this] { return SendFront(); });
    if (status.ok()) continue;
    const absl::Duration delay = backoff_.Next();
    absl::MutexLock lock(&mutex_);
    has_work_ = true;
    if (stopping_) return;
    logger_.Warning("loop closures not sent: ", status.ToString(), "; again in ",
                    absl::FormatDuration(delay));
    if (mutex_.AwaitWithTimeout(absl::Condition(&stopping_), delay)) return;
  }
}

bool LoopClosureUploader::AwaitWork() {
  const auto ready = [this] {
    mutex_.AssertHeld();
    return stopping_ || has_work_;
  };
  absl::MutexLock lock(&mutex_, absl::Condition(&ready));
  has_work_ = false;  // before looking, so that a batch pushed while we look is not overlooked
  return !stopping_;
}

// Not ok: try again later.
absl::Status LoopClosureUploader::SendFront() {
  const SharedBytes batch = outbox_->FrontLoopClosures();
  if (batch == nullptr) return absl::OkStatus();
  v1::AddLoopClosuresRequest request;
  if (!request.ParseFromString(*batch))
    return absl::DataLossError("a batch in the outbox is damaged");
  const bool submaps_waiting = outbox_->Level().submaps > 0;  // before the call: they may go up
  const absl::Status status = Call(request);
  // The batch has overtaken the submap that brings the map into being.
  if (absl::IsNotFound(status) && submaps_waiting) return status;
  // Access can be granted any time; until then nothing is lost.
  if (IsAccessRefused(status.code())) return status;
  if (IsRetryable(status.code()) || absl::IsCancelled(status)) return status;
  if (!status.ok()) on_refusal_(status);
  outbox_->PopLoopClosures();
  backoff_.Reset();
  Notify();  // there may be more
  return absl::OkStatus();
}

absl::Status LoopClosureUploader::Call(const v1::AddLoopClosuresRequest& request) {
  grpc::ClientContext context;
  context.set_wait_for_ready(true);
  context.set_deadline(std::chrono::system_clock::now() + absl::ToChronoMilliseconds(kCallTimeout));
  {
    absl::MutexLock lock(&mutex_);
    if (stopping_) return absl::CancelledError("stopping");
    call_ = &context;
  }
  v1::AddLoopClosuresResponse response;
  const grpc::Status status = stub_->AddLoopClosures(&context, request, &response);
  {
    absl::MutexLock lock(&mutex_);
    call_ = nullptr;
  }
  const int64_t bytes = static_cast<int64_t>(request.ByteSizeLong());
  counters_->bytes_sent += bytes;
  if (bucket_ != nullptr) bucket_->Take(bytes, TokenBucket::Clock::now());
  counters_->bytes_received += response.ByteSizeLong();
  return FromGrpcStatus(status);
}

}  // namespace overtone
