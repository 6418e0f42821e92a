// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_WORKER_POOL_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_WORKER_POOL_H_

#include <cstdint>
#include <deque>
#include <functional>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"

namespace overtone {

// Runs tasks on its own threads, in the order in which they come. Thread-safe; tasks may post
// tasks. A task that throws is logged.
class WorkerPool {
 public:
  explicit WorkerPool(int num_threads);
  // Lets the tasks under way finish and drops those that wait.
  ~WorkerPool();

  void Post(std::function<void()> task);

  // Tasks that wait or are under way.
  int64_t backlog() const;

 private:
  void Run();

  mutable absl::Mutex mutex_;
  std::deque<std::function<void()>> tasks_ ABSL_GUARDED_BY(mutex_);
  int64_t running_ ABSL_GUARDED_BY(mutex_) = 0;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::vector<std::thread> threads_;  // last: start when all else is there
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_WORKER_POOL_H_
