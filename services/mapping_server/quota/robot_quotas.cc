// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/quota/robot_quotas.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/status_conversion.h"

namespace overtone {
namespace {

// What comes at once is stored with one fsync, and the neighbours have the disk for themselves in
// between. The rate is the same: the tokens of the pause are there after it.
constexpr absl::Duration kShortestPause = absl::Milliseconds(500);

}  // namespace

absl::Time MonotonicNow() {
  return absl::UnixEpoch() + absl::FromChrono(std::chrono::steady_clock::now().time_since_epoch());
}

RobotQuotas::RobotQuotas(const QuotaOptions& options, Clock now)
    : options_(options), now_(std::move(now)) {}

RobotQuotas::Robot& RobotQuotas::Find(const std::string& who) {
  const auto it = robots_.find(who);
  if (it != robots_.end()) return it->second;
  if (robots_.size() >= sweep_at_) Sweep();
  return robots_.emplace(who, options_).first->second;
}

void RobotQuotas::Sweep() {
  const absl::Time now = now_();
  for (auto it = robots_.begin(); it != robots_.end();) {
    Robot& robot = it->second;
    const bool as_new = robot.streams == 0 && robot.messages.IsFull(now) &&
                        robot.bytes.IsFull(now) && robot.calls.IsFull(now);
    it = as_new ? robots_.erase(it) : std::next(it);
  }
  sweep_at_ = std::max<size_t>(64, 2 * robots_.size());
}

absl::Status RobotQuotas::AdmitCall(const std::string& who) {
  absl::MutexLock lock(&mutex_);
  return Admit(who);
}

absl::Status RobotQuotas::Admit(const std::string& who) {
  const absl::Duration wait = Find(who).calls.TryTake(1, now_());
  if (wait == absl::ZeroDuration()) return absl::OkStatus();
  ++refusals_.calls;
  return WithRetryDelay(
      QuotaExceeded(absl::StrCat(who, "/calls"),
                    absl::StrCat("at most ", options_.max_calls_per_s, " calls per second")),
      wait);
}

absl::StatusOr<std::shared_ptr<const std::string>> RobotQuotas::OpenStream(const std::string& who) {
  absl::MutexLock lock(&mutex_);
  RETURN_IF_ERROR(Admit(who));
  Robot& robot = Find(who);
  if (options_.max_streams > 0 && robot.streams >= options_.max_streams) {
    ++refusals_.streams;
    return QuotaExceeded(absl::StrCat(who, "/streams"),
                         absl::StrCat("at most ", options_.max_streams, " streams at once"));
  }
  ++robot.streams;
  return std::shared_ptr<const std::string>(new std::string(who), [this](const std::string* name) {
    CloseStream(*name);
    delete name;
  });
}

size_t RobotQuotas::size() const {
  absl::MutexLock lock(&mutex_);
  return robots_.size();
}

void RobotQuotas::CloseStream(const std::string& who) {
  absl::MutexLock lock(&mutex_);
  --Find(who).streams;
}

absl::Duration RobotQuotas::Charge(const std::string& who, int64_t bytes) {
  absl::MutexLock lock(&mutex_);
  Robot& robot = Find(who);
  const absl::Time now = now_();
  const absl::Duration pause =
      std::max(robot.messages.Charge(1, now, kShortestPause),
               robot.bytes.Charge(static_cast<double>(bytes), now, kShortestPause));
  if (pause > absl::ZeroDuration()) ++refusals_.uploads;
  return pause;
}

}  // namespace overtone
