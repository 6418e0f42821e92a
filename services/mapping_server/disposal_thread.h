// SPDX-License-Identifier: Apache-2.0
// For what joins threads when it is destroyed and may be let go of by one of them.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_DISPOSAL_THREAD_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_DISPOSAL_THREAD_H_

#include <deque>
#include <functional>
#include <memory>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"

namespace overtone {

// Runs what it is given, one after the other, on a thread of its own.
class DisposalThread {
 public:
  DisposalThread();
  // Finishes what it was given.
  ~DisposalThread();

  using Disposer = std::function<void(std::function<void()>)>;
  // Thread-safe, and may outlive this: then each task gets a thread.
  Disposer disposer() const;

 private:
  struct Tasks {
    bool HasNews() const ABSL_SHARED_LOCKS_REQUIRED(mutex) { return closed || !waiting.empty(); }

    absl::Mutex mutex;
    std::deque<std::function<void()>> waiting ABSL_GUARDED_BY(mutex);
    bool closed ABSL_GUARDED_BY(mutex) = false;
  };

  const std::shared_ptr<Tasks> tasks_;
  std::thread thread_;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_DISPOSAL_THREAD_H_
