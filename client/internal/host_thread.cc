// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/host_thread.h"

#include <algorithm>
#include <utility>

#include "overtone/client/internal/comparison_pace.h"
#include "overtone/client/internal/exception_guard.h"

namespace overtone {

HostThread::HostThread(MissionId mission, SynchronizationOptions options,
                       absl::Duration min_time_between_comparisons, HostEstimator* host,
                       Logger logger, ComparisonHandler on_comparison)
    : mission_(mission),
      min_time_between_comparisons_(min_time_between_comparisons),
      host_(host),
      logger_(std::move(logger)),
      on_comparison_(std::move(on_comparison)),
      synchronizer_(std::move(mission), std::move(options), host) {
  thread_ = std::thread([this] { Run(); });
}

HostThread::~HostThread() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
  }
  thread_.join();
  absl::MutexLock lock(&mutex_);
  for (const std::shared_ptr<Request>& request : requests_) request->done = true;
}

void HostThread::OnGraph(std::shared_ptr<const MapGraph> graph) {
  absl::MutexLock lock(&mutex_);
  graph_ = std::move(graph);
  graph_is_new_ = true;
}

void HostThread::OnLinkState(LinkState state) {
  absl::MutexLock lock(&mutex_);
  link_state_ = state;
  calls_.push_back([state](HostEstimator& host) { host.OnLinkState(state); });
}

void HostThread::Post(std::function<void(HostEstimator&)> call) {
  absl::MutexLock lock(&mutex_);
  calls_.push_back(std::move(call));
}

absl::StatusOr<SynchronizationReport> HostThread::Synchronize() {
  if (std::this_thread::get_id() == thread_.get_id()) {
    return absl::FailedPreconditionError(
        "Synchronize() must not be called from within the host's callbacks");
  }
  const auto request = std::make_shared<Request>();
  absl::MutexLock lock(&mutex_);
  requests_.push_back(request);
  mutex_.Await(absl::Condition(&request->done));
  return std::move(request->result);
}

absl::Status HostThread::WaitForKeyframe(int64_t index, uint64_t min_revision,
                                         absl::Duration timeout) const {
  const auto holds = [&] { return GraphHolds(index, min_revision); };
  absl::MutexLock lock(&mutex_);
  if (mutex_.AwaitWithTimeout(absl::Condition(&holds), timeout)) return absl::OkStatus();
  return absl::DeadlineExceededError(absl::StrCat("no graph with keyframe ", index,
                                                  " and a revision of at least ", min_revision,
                                                  " after ", absl::FormatDuration(timeout)));
}

// Reduction may leave out the keyframe itself, never the mission's last one.
bool HostThread::GraphHolds(int64_t index, uint64_t min_revision) const {
  mutex_.AssertHeld();
  if (graph_ == nullptr || graph_->revision < min_revision) return false;
  return std::any_of(graph_->missions.begin(), graph_->missions.end(),
                     [&](const MapMission& mission) {
                       return mission.id == mission_ && !mission.nodes.empty() &&
                              mission.nodes.back().index >= index;
                     });
}

std::shared_ptr<const MapGraph> HostThread::Graph() const {
  absl::MutexLock lock(&mutex_);
  return graph_;
}

LinkState HostThread::link_state() const {
  absl::MutexLock lock(&mutex_);
  return link_state_;
}

int64_t HostThread::comparisons() const {
  absl::MutexLock lock(&mutex_);
  return comparisons_;
}

void HostThread::Run() {
  while (AwaitWork()) {
    MakePostedCalls();
    AnswerRequests();
    CompareIfDue();
  }
}

bool HostThread::AwaitWork() {
  const auto has_work = [this] {
    mutex_.AssertHeld();
    return stopping_ || !calls_.empty() || !requests_.empty();
  };
  const auto has_work_or_graph = [&] { return has_work() || (mutex_.AssertHeld(), graph_is_new_); };
  absl::MutexLock lock(&mutex_);
  if (min_time_between_comparisons_ == absl::InfiniteDuration()) {
    mutex_.Await(absl::Condition(&has_work));
    return !stopping_;
  }
  if (last_comparison_) {
    const absl::Duration since = absl::FromChrono(Clock::now() - *last_comparison_);
    mutex_.AwaitWithTimeout(absl::Condition(&has_work), pause_after_comparison_ - since);
  }
  mutex_.Await(absl::Condition(&has_work_or_graph));
  return !stopping_;
}

void HostThread::MakePostedCalls() {
  std::deque<std::function<void(HostEstimator&)>> calls;
  {
    absl::MutexLock lock(&mutex_);
    calls.swap(calls_);
  }
  for (const auto& call : calls) {
    const absl::Status status =
        GuardExceptions("HostEstimator", [&] { return call(*host_), absl::OkStatus(); });
    if (!status.ok()) logger_.Error(status.ToString());
  }
}

void HostThread::AnswerRequests() {
  std::deque<std::shared_ptr<Request>> requests;
  {
    absl::MutexLock lock(&mutex_);
    requests.swap(requests_);
  }
  for (const std::shared_ptr<Request>& request : requests) {
    absl::StatusOr<SynchronizationReport> result = Compare();
    absl::MutexLock lock(&mutex_);
    request->result = std::move(result);
    request->done = true;
  }
}

void HostThread::CompareIfDue() {
  if (min_time_between_comparisons_ == absl::InfiniteDuration()) return;
  if (last_comparison_ &&
      absl::FromChrono(Clock::now() - *last_comparison_) < pause_after_comparison_) {
    return;
  }
  {
    absl::MutexLock lock(&mutex_);
    if (stopping_ || !graph_is_new_) return;
  }
  const absl::StatusOr<SynchronizationReport> report = Compare();
  if (!report.ok()) {
    logger_.Info("no comparison: ", report.status().ToString());
  } else if (!report->host_status.ok()) {
    logger_.Error("the host refused a batch of constraints: ", report->host_status.ToString());
  }
}

absl::StatusOr<SynchronizationReport> HostThread::Compare() {
  std::shared_ptr<const MapGraph> graph;
  {
    absl::MutexLock lock(&mutex_);
    graph = graph_;
    graph_is_new_ = false;
  }
  if (graph == nullptr)
    return absl::FailedPreconditionError("no graph has come from the server yet");
  const Clock::time_point begin = Clock::now();
  absl::StatusOr<SynchronizationReport> report =
      GuardExceptions("comparison", [&] { return synchronizer_.Synchronize(*graph); });
  last_comparison_ = Clock::now();
  pause_after_comparison_ = PauseAfterComparison(absl::FromChrono(*last_comparison_ - begin),
                                                 min_time_between_comparisons_);
  if (!report.ok()) return report;
  {
    absl::MutexLock lock(&mutex_);
    ++comparisons_;
  }
  if (on_comparison_ != nullptr) on_comparison_(*report);
  return report;
}

}  // namespace overtone
