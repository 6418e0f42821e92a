// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/disposal_thread.h"

#include <utility>

namespace overtone {

DisposalThread::DisposalThread() : tasks_(std::make_shared<Tasks>()) {
  thread_ = std::thread([tasks = tasks_] {
    while (true) {
      std::function<void()> task;
      {
        absl::MutexLock lock(&tasks->mutex, absl::Condition(tasks.get(), &Tasks::HasNews));
        if (tasks->waiting.empty()) return;
        task = std::move(tasks->waiting.front());
        tasks->waiting.pop_front();
      }
      task();
    }
  });
}

DisposalThread::~DisposalThread() {
  {
    absl::MutexLock lock(&tasks_->mutex);
    tasks_->closed = true;
  }
  thread_.join();
}

DisposalThread::Disposer DisposalThread::disposer() const {
  return [tasks = tasks_](std::function<void()> task) {
    {
      absl::MutexLock lock(&tasks->mutex);
      if (!tasks->closed) {
        tasks->waiting.push_back(std::move(task));
        return;
      }
    }
    std::thread(std::move(task)).detach();
  };
}

}  // namespace overtone
