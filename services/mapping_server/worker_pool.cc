// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/worker_pool.h"

#include <exception>
#include <utility>

#include "overtone/services/mapping_server/background_thread.h"
#include "spdlog/spdlog.h"

namespace overtone {

WorkerPool::WorkerPool(int num_threads) {
  for (int i = 0; i < num_threads; ++i) threads_.emplace_back([this] { Run(); });
}

WorkerPool::~WorkerPool() {
  {
    absl::MutexLock lock(&mutex_);
    stopping_ = true;
  }
  for (std::thread& thread : threads_) thread.join();
}

void WorkerPool::Post(std::function<void()> task) {
  absl::MutexLock lock(&mutex_);
  tasks_.push_back(std::move(task));
}

int64_t WorkerPool::backlog() const {
  absl::MutexLock lock(&mutex_);
  return static_cast<int64_t>(tasks_.size()) + running_;
}

void WorkerPool::Run() {
  RunInBackground();
  const auto something_to_do = [this]() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_) {
    return stopping_ || !tasks_.empty();
  };
  for (;;) {
    std::function<void()> task;
    {
      absl::MutexLock lock(&mutex_, absl::Condition(&something_to_do));
      if (stopping_) return;
      task = std::move(tasks_.front());
      tasks_.pop_front();
      ++running_;
    }
    try {
      task();
    } catch (const std::exception& error) {
      spdlog::error("a task failed: {}", error.what());
    }
    absl::MutexLock lock(&mutex_);
    --running_;
  }
}

}  // namespace overtone
