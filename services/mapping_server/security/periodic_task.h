// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_PERIODIC_TASK_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_PERIODIC_TASK_H_

#include <functional>
#include <thread>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"

namespace overtone {

// Runs `task` every `period` on a thread of its own, first after one period, until it is destroyed.
class PeriodicTask {
 public:
  PeriodicTask(absl::Duration period, std::function<void()> task)
      : thread_([this, period, task = std::move(task)] {
          while (!AwaitStop(period)) task();
        }) {}
  ~PeriodicTask() {
    {
      absl::MutexLock lock(&mutex_);
      stopping_ = true;
    }
    thread_.join();
  }

 private:
  bool AwaitStop(absl::Duration period) {
    absl::MutexLock lock(&mutex_);
    return mutex_.AwaitWithTimeout(absl::Condition(&stopping_), period);
  }

  absl::Mutex mutex_;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;  // last: starts when all else is there
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SECURITY_PERIODIC_TASK_H_
