// SPDX-License-Identifier: Apache-2.0
// The one thread from which the host is called: comparisons, link states, refusals.
#ifndef OVERTONE_CLIENT_INTERNAL_HOST_THREAD_H_
#define OVERTONE_CLIENT_INTERNAL_HOST_THREAD_H_

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/client/host_estimator.h"
#include "overtone/client/internal/graph_synchronizer.h"
#include "overtone/client/internal/logger.h"
#include "overtone/client/mapping_client.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/graph/map_graph.h"

namespace overtone {

// Thread-safe. The newest graph wins: one that comes while the host is busy replaces the one that
// waits.
class HostThread {
 public:
  // Called on the thread after each comparison.
  using ComparisonHandler = std::function<void(const SynchronizationReport&)>;

  // `host` must outlive this.
  HostThread(MissionId mission, SynchronizationOptions options,
             absl::Duration min_time_between_comparisons, HostEstimator* host, Logger logger,
             ComparisonHandler on_comparison = nullptr);
  ~HostThread();  // waits for the host's call under way, if any

  // Queued for the thread; return at once.
  void OnGraph(std::shared_ptr<const MapGraph> graph) ABSL_LOCKS_EXCLUDED(mutex_);
  // GraphSynchronizer::AddKeyframes.
  void AddKeyframes(int64_t first_index, const std::vector<Keyframe>& keyframes) {
    synchronizer_.AddKeyframes(first_index, keyframes);
  }
  void OnLinkState(LinkState state) ABSL_LOCKS_EXCLUDED(mutex_);
  void Post(std::function<void(HostEstimator&)> call) ABSL_LOCKS_EXCLUDED(mutex_);

  // As in MappingClient.
  absl::StatusOr<SynchronizationReport> Synchronize() ABSL_LOCKS_EXCLUDED(mutex_);
  absl::Status WaitForKeyframe(int64_t index, uint64_t min_revision, absl::Duration timeout) const
      ABSL_LOCKS_EXCLUDED(mutex_);
  std::shared_ptr<const MapGraph> Graph() const ABSL_LOCKS_EXCLUDED(mutex_);
  LinkState link_state() const ABSL_LOCKS_EXCLUDED(mutex_);
  int64_t comparisons() const ABSL_LOCKS_EXCLUDED(mutex_);

 private:
  using Clock = std::chrono::steady_clock;
  struct Request {
    absl::StatusOr<SynchronizationReport> result = absl::CancelledError("the client stopped");
    bool done = false;
  };

  void Run();
  // Waits until there is something to do. False: stop.
  bool AwaitWork() ABSL_LOCKS_EXCLUDED(mutex_);
  void MakePostedCalls() ABSL_LOCKS_EXCLUDED(mutex_);
  void AnswerRequests() ABSL_LOCKS_EXCLUDED(mutex_);
  void CompareIfDue() ABSL_LOCKS_EXCLUDED(mutex_);
  absl::StatusOr<SynchronizationReport> Compare() ABSL_LOCKS_EXCLUDED(mutex_);
  bool GraphHolds(int64_t index, uint64_t min_revision) const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const MissionId mission_;
  const absl::Duration min_time_between_comparisons_;
  HostEstimator* const host_;
  const Logger logger_;
  const ComparisonHandler on_comparison_;
  GraphSynchronizer synchronizer_;  // the thread's own
  // The thread's own.
  std::optional<Clock::time_point> last_comparison_;
  absl::Duration pause_after_comparison_;

  mutable absl::Mutex mutex_;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::deque<std::function<void(HostEstimator&)>> calls_ ABSL_GUARDED_BY(mutex_);
  std::deque<std::shared_ptr<Request>> requests_ ABSL_GUARDED_BY(mutex_);
  std::shared_ptr<const MapGraph> graph_ ABSL_GUARDED_BY(mutex_);
  bool graph_is_new_ ABSL_GUARDED_BY(mutex_) = false;  // not compared yet
  LinkState link_state_ ABSL_GUARDED_BY(mutex_) = LinkState::kConnecting;
  int64_t comparisons_ ABSL_GUARDED_BY(mutex_) = 0;
  std::thread thread_;  // last: it uses everything above
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_HOST_THREAD_H_
