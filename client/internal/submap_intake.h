// SPDX-License-Identifier: Apache-2.0
// The thread between the host's calls and the outbox: encodes clouds, writes to disk.
#ifndef OVERTONE_CLIENT_INTERNAL_SUBMAP_INTAKE_H_
#define OVERTONE_CLIENT_INTERNAL_SUBMAP_INTAKE_H_

#include <chrono>
#include <cstdint>
#include <deque>
#include <functional>
#include <thread>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/client/internal/logger.h"
#include "overtone/client/internal/submap_outbox.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/core/graph/submap.h"
#include "overtone/v1/submap.pb.h"

namespace overtone {

// Owns one thread, the only one that writes to the outbox's file. Thread-safe; no call but
// AwaitStored waits for anything.
class SubmapIntake {
 public:
  // Clouds as the host gave them, that wait for their encoding: above it those of the oldest
  // submaps are dropped. A robot fills it in a minute when the disk stands still (20,000 points,
  // 4 Hz). One submap may have more by itself.
  static constexpr int64_t kMaxRawCloudBytes = 64 << 20;

  // `on_stored` after each change of the outbox, from the intake's thread. `outbox` outlives this.
  SubmapIntake(SubmapOutbox* outbox, CloudCodecOptions clouds, absl::Duration sync_interval,
               Logger logger, std::function<void()> on_stored);
  ~SubmapIntake() { Stop(); }

  void Start();
  // What was handed over goes to the file first, if there is one.
  void Stop();

  // For `message` (checked; its clouds announced) `reserved` bytes of the outbox are reserved.
  void Push(v1::Submap message, std::vector<KeyframeCloud> clouds, int64_t reserved);
  // Something else was pushed into the outbox.
  void Notify();

  // Forgets the submap of this sequence and all that follow. Returns their sequences. What is in
  // the outbox already stays there.
  std::vector<int64_t> DropFrom(int64_t sequence);

  // False: after `timeout`, something that was handed over before the call is not in the outbox
  // and, if that has one, in its file.
  bool AwaitStored(absl::Duration timeout) const;

  // Clouds that are not encoded yet.
  int64_t clouds_waiting() const;

 private:
  struct Item {
    v1::Submap message;
    std::vector<KeyframeCloud> clouds;
    int64_t reserved = 0;
    int64_t raw_bytes = 0;
  };
  using Clock = std::chrono::steady_clock;

  void Run();
  void Work();
  // False: nothing to do before the next sync is due.
  bool TakeNext(Item& item);
  void Store(Item item);
  void WriteToDisk();
  void DropClouds(Item& item) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);
  void Drop(const Item& item) ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  SubmapOutbox* const outbox_;
  const CloudCodecOptions codec_;
  const absl::Duration sync_interval_;
  const Logger logger_;
  const std::function<void()> on_stored_;
  Clock::time_point next_sync_;  // the thread's own
  int64_t unwritten_bytes_ = 0;  // the thread's own

  mutable absl::Mutex mutex_;
  std::deque<Item> queue_ ABSL_GUARDED_BY(mutex_);
  int64_t raw_bytes_ ABSL_GUARDED_BY(mutex_) = 0;
  int64_t clouds_waiting_ ABSL_GUARDED_BY(mutex_) = 0;
  int64_t storing_ ABSL_GUARDED_BY(mutex_) = -1;  // sequence of the one the thread has taken
  bool storing_dropped_ ABSL_GUARDED_BY(mutex_) = false;
  bool notified_ ABSL_GUARDED_BY(mutex_) = false;
  // What was handed over, counted; through which it is stored.
  int64_t handed_over_ ABSL_GUARDED_BY(mutex_) = 0;
  int64_t stored_ ABSL_GUARDED_BY(mutex_) = 0;
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace overtone

#endif  // OVERTONE_CLIENT_INTERNAL_SUBMAP_INTAKE_H_
