// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/clock_probe.h"

#include <utility>

#include "absl/time/clock.h"

namespace overtone {
namespace {

constexpr std::chrono::seconds kInterval(30);
// The first few come as fast as the server is heard: one alone may have had a slow way.
constexpr int kFastAnswers = 4;
constexpr std::chrono::seconds kTimeout(5);

absl::Duration SinceStart(std::chrono::steady_clock::time_point time) {
  return absl::FromChrono(time.time_since_epoch());
}

absl::Time FromProto(const google::protobuf::Timestamp& time) {
  return absl::FromUnixSeconds(time.seconds()) + absl::Nanoseconds(time.nanos());
}

}  // namespace

ClockProbe::ClockProbe(v1::MappingService::Stub* stub, absl::Duration warn_above,
                       TrafficCounters* counters, Logger logger)
    : stub_(stub), counters_(counters), logger_(std::move(logger)), warning_(warn_above) {}

ClockProbe::~ClockProbe() {
  const auto answered = [this] { return mutex_.AssertHeld(), question_ == nullptr; };
  absl::MutexLock lock(&mutex_);
  stopping_ = true;
  if (question_ != nullptr) question_->context.TryCancel();
  mutex_.Await(absl::Condition(&answered));
}

void ClockProbe::OnHeard() {
  Question* question = nullptr;
  {
    absl::MutexLock lock(&mutex_);
    if (question_ != nullptr || stopping_ || Clock::now() < next_) return;
    question_ = std::make_unique<Question>();
    question = question_.get();
  }
  question->context.set_deadline(std::chrono::system_clock::now() + kTimeout);
  question->sent = absl::Now();
  question->sent_steady = Clock::now();
  stub_->async()->GetServerInfo(&question->context, &question->request, &question->response,
                                [this](grpc::Status status) { OnAnswer(status); });
}

// On a thread of gRPC's.
void ClockProbe::OnAnswer(const grpc::Status& status) {
  const Clock::time_point received = Clock::now();
  std::optional<ClockOffset::Estimate> estimate;
  ClockWarning::Word word = ClockWarning::Word::kNone;
  {
    absl::MutexLock lock(&mutex_);
    if (status.ok()) Learn(received);
    if (status.ok()) estimate = offset_.Get(SinceStart(received));
    if (estimate) word = warning_.Judge(*estimate);
    if (!status.ok() || ++answers_ >= kFastAnswers) next_ = received + kInterval;
  }
  if (estimate) Tell(word, *estimate);
  std::unique_ptr<Question> done;
  absl::MutexLock lock(&mutex_);  // the last touch: who destroys this waits for it
  done = std::move(question_);
}

void ClockProbe::Learn(Clock::time_point received) {
  counters_->bytes_received += static_cast<int64_t>(question_->response.ByteSizeLong());
  if (!question_->response.has_server_time()) return;  // an older server
  offset_.Add(question_->sent, absl::FromChrono(received - question_->sent_steady),
              FromProto(question_->response.server_time()), SinceStart(received));
}

void ClockProbe::Tell(ClockWarning::Word word, const ClockOffset::Estimate& estimate) const {
  if (word == ClockWarning::Word::kNone) return;
  const double offset_s = absl::ToDoubleSeconds(estimate.offset);
  const double uncertainty_s = absl::ToDoubleSeconds(estimate.uncertainty);
  if (word == ClockWarning::Word::kWarn) {
    logger_.Warning("this clock is ", offset_s, " s ahead of the server's, within ", uncertainty_s,
                    " s; stamps of robots do not compare");
  } else {
    logger_.Info("this clock agrees with the server's again: ", offset_s, " s");
  }
}

std::optional<ClockOffset::Estimate> ClockProbe::Offset() const {
  absl::MutexLock lock(&mutex_);
  return offset_.Get(SinceStart(Clock::now()));
}

}  // namespace overtone
