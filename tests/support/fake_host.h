// SPDX-License-Identifier: Apache-2.0
// A host that records what the client tells it, and misbehaves on request.
#ifndef OVERTONE_TESTS_SUPPORT_FAKE_HOST_H_
#define OVERTONE_TESTS_SUPPORT_FAKE_HOST_H_

#include <functional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/client/host_estimator.h"

namespace overtone {

class FakeHost final : public HostEstimator {
 public:
  // All public members are guarded by `mutex`.
  mutable absl::Mutex mutex;
  std::vector<OnboardPose> trajectory ABSL_GUARDED_BY(mutex);
  absl::Status answer ABSL_GUARDED_BY(mutex);  // of ApplyConstraints
  bool throws ABSL_GUARDED_BY(mutex) = false;  // from every call
  std::function<void()> on_apply ABSL_GUARDED_BY(mutex);
  std::vector<ConstraintBatch> batches ABSL_GUARDED_BY(mutex);
  std::vector<LinkState> link_states ABSL_GUARDED_BY(mutex);
  std::vector<std::pair<int64_t, absl::Status>> rejected ABSL_GUARDED_BY(mutex);
  std::vector<absl::Status> rejected_closures ABSL_GUARDED_BY(mutex);

  std::vector<int64_t> clouds_dropped ABSL_GUARDED_BY(mutex);

  std::vector<OnboardPose> Trajectory() override {
    absl::MutexLock lock(&mutex);
    ThrowIfAsked();
    return trajectory;
  }

  absl::Status ApplyConstraints(const ConstraintBatch& batch) override {
    std::function<void()> hook;
    {
      absl::MutexLock lock(&mutex);
      batches.push_back(batch);
      ThrowIfAsked();
      hook = on_apply;
    }
    if (hook) hook();
    absl::MutexLock lock(&mutex);
    return answer;
  }

  void OnLinkState(LinkState state) override {
    absl::MutexLock lock(&mutex);
    link_states.push_back(state);
    ThrowIfAsked();
  }

  void OnSubmapRejected(int64_t sequence, const absl::Status& reason) override {
    absl::MutexLock lock(&mutex);
    rejected.emplace_back(sequence, reason);
    ThrowIfAsked();
  }

  void OnCloudsDropped(int64_t total) override {
    absl::MutexLock lock(&mutex);
    clouds_dropped.push_back(total);
    ThrowIfAsked();
  }

  void OnLoopClosuresRejected(const absl::Status& reason) override {
    absl::MutexLock lock(&mutex);
    rejected_closures.push_back(reason);
    ThrowIfAsked();
  }

  // Waits until condition(), evaluated under the mutex, holds.
  template <typename Condition>
  bool Await(const Condition& condition, absl::Duration timeout = absl::Seconds(20)) const {
    absl::MutexLock lock(&mutex);
    return mutex.AwaitWithTimeout(absl::Condition(&condition), timeout);
  }

 private:
  void ThrowIfAsked() const ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex) {
    if (throws) throw std::runtime_error("the host is out of order");
  }
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_FAKE_HOST_H_
