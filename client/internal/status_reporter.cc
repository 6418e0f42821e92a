// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/status_reporter.h"

#include <algorithm>
#include <utility>

#include "absl/time/clock.h"
#include "overtone/client/internal/exception_guard.h"
#include "overtone/proto/conversion/id_conversion.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {
namespace {

constexpr absl::Duration kCallTimeout = absl::Seconds(10);
// What a server may ask for.
constexpr absl::Duration kShortestInterval = absl::Seconds(1);
constexpr absl::Duration kLongestInterval = absl::Hours(1);

}  // namespace

StatusReporter::StatusReporter(v1::MappingService::Stub* stub, Settings settings, LinkSource link,
                               TrafficCounters* counters, TokenBucket* bucket, Logger logger)
    : stub_(stub),
      settings_(std::move(settings)),
      link_(std::move(link)),
      counters_(counters),
      bucket_(bucket),
      logger_(std::move(logger)),
      detail_(ReportDetail::ForLink(settings_.max_upload_bytes_per_s, settings_.interval)),
      share_(settings_.max_upload_bytes_per_s == 0
                 ? 0
                 : std::max<int64_t>(1, settings_.max_upload_bytes_per_s / 20)),
      interval_(settings_.interval),
      last_(Clock::now()) {}

void StatusReporter::Start() {
  thread_ = std::thread([this] { Run(); });
}

void StatusReporter::Stop() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
    if (call_ != nullptr) call_->TryCancel();
  }
  if (thread_.joinable()) thread_.join();
}

void StatusReporter::OnComparison(const SynchronizationReport& report) {
  v1::ComparisonReport message = ToProto(report, detail_, absl::Now());
  absl::MutexLock lock(&mutex_);
  if (!stopping_) comparison_ = std::move(message);
}

void StatusReporter::Run() {
  while (AwaitDue()) {
    const absl::Status status =
        GuardExceptions("status report", [this] { return Report(), absl::OkStatus(); });
    if (!status.ok()) logger_.Error(status.ToString());
  }
}

StatusReporter::Clock::time_point StatusReporter::DueAt() const {
  const absl::Duration gap =
      comparison_.has_value() ? std::min(settings_.min_gap, interval_) : interval_;
  return std::max(not_before_, last_ + absl::ToChronoNanoseconds(gap));
}

bool StatusReporter::AwaitDue() {
  while (true) {
    const Clock::time_point now = Clock::now();
    const Clock::time_point affordable = std::max(bucket_->ReadyAt(now), share_.ReadyAt(now));
    absl::MutexLock lock(&mutex_);
    if (stopping_) return false;
    const Clock::time_point due = std::max(DueAt(), affordable);
    if (due <= now) return true;
    // Nothing wakes us for what cannot go out yet anyway.
    const bool waited_for_comparison = comparison_.has_value();
    const auto changed = [&] {
      mutex_.AssertHeld();
      return stopping_ || comparison_.has_value() != waited_for_comparison;
    };
    mutex_.AwaitWithTimeout(absl::Condition(&changed), absl::FromChrono(due - now));
  }
}

void StatusReporter::Report() {
  v1::ReportStatusRequest request;
  request.set_map(settings_.map);
  *request.mutable_mission() = overtone::ToProto(settings_.mission);
  *request.mutable_link() = link_();
  {
    absl::MutexLock lock(&mutex_);
    last_ = Clock::now();
    if (comparison_.has_value()) *request.mutable_comparison() = *std::move(comparison_);
    comparison_.reset();
  }
  v1::ReportStatusResponse response;
  const absl::Status status = Call(request, response);
  if (status.ok()) return OnTaken(response);
  OnNotTaken(status, request);
}

absl::Status StatusReporter::Call(const v1::ReportStatusRequest& request,
                                  v1::ReportStatusResponse& response) {
  grpc::ClientContext context;
  context.set_deadline(std::chrono::system_clock::now() + absl::ToChronoMilliseconds(kCallTimeout));
  {
    absl::MutexLock lock(&mutex_);
    if (stopping_) return absl::CancelledError("stopping");
    call_ = &context;
  }
  const int64_t bytes = static_cast<int64_t>(request.ByteSizeLong());
  counters_->bytes_sent += bytes;
  counters_->report_bytes_sent += bytes;
  bucket_->Take(bytes, Clock::now());
  share_.Take(bytes, Clock::now());
  const grpc::Status status = stub_->ReportStatus(&context, request, &response);
  counters_->bytes_received += static_cast<int64_t>(response.ByteSizeLong());
  absl::MutexLock lock(&mutex_);
  call_ = nullptr;
  return FromGrpcStatus(status);
}

void StatusReporter::OnTaken(const v1::ReportStatusResponse& response) {
  absl::MutexLock lock(&mutex_);
  interval_ = settings_.interval;
  if (response.next_report_s() > 0) {  // false for NaN
    interval_ =
        std::clamp(absl::Seconds(response.next_report_s()), kShortestInterval, kLongestInterval);
  }
}

// Never at once again: the link may be down for long.
void StatusReporter::OnNotTaken(const absl::Status& status, v1::ReportStatusRequest& request) {
  const bool will_not_be = absl::IsUnimplemented(status) || absl::IsInvalidArgument(status);
  if (absl::IsInvalidArgument(status)) {
    logger_.Warning("the server does not take our status reports: ", status.ToString());
  }
  absl::MutexLock lock(&mutex_);
  const absl::Duration pause = will_not_be ? settings_.refused_pause : interval_;
  not_before_ = Clock::now() + absl::ToChronoNanoseconds(pause);
  if (will_not_be) {
    comparison_.reset();
  } else if (!comparison_.has_value() && request.has_comparison()) {
    comparison_ = std::move(*request.mutable_comparison());
  }
}

}  // namespace overtone
