// SPDX-License-Identifier: Apache-2.0
// What waits for the writer, a lane for each robot, and how much of each makes a batch: one robot's
// backlog is not in the way of another's next submap.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_OPERATION_QUEUE_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_OPERATION_QUEUE_H_

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "overtone/services/mapping_server/submap_store/store_operation.h"

namespace overtone {

// What one transaction holds; grows while it is written.
struct OperationBatch {
  std::vector<std::unique_ptr<StoreOperation>> operations;
  int64_t bytes = 0;
  std::map<std::string, int> by_lane;
};

// Thread-safe. Within a lane, first come, first served; the lanes take turns.
class OperationQueue {
 public:
  // A batch ends at the first operation at which it has so much.
  struct BatchLimits {
    int64_t bytes = 4 << 20;
    int operations = 512;
    // Of one lane, once another is in the batch: what somebody who comes while a backlog is being
    // written still waits for.
    int lane_beside_others = 16;
  };

  void Push(std::unique_ptr<StoreOperation> operation);
  // Waits until there is something. False: closed, and nothing is left.
  bool Wait() const;
  // Moves the next operation that belongs into the batch, and returns it; null: the batch is
  // complete. Who comes while the batch is written still has a place in it.
  StoreOperation* Extend(OperationBatch& batch, const BatchLimits& limits);
  // So many of those taken are finished.
  void Finished(size_t count);
  bool empty() const;
  int64_t unfinished() const;
  // Waits until all that was pushed is finished.
  void AwaitFinished() const;
  // What waits can still be taken.
  void Close();

 private:
  using Lanes = std::map<std::string, std::deque<std::unique_ptr<StoreOperation>>>;

  bool AllFinished() const ABSL_SHARED_LOCKS_REQUIRED(mutex_) { return unfinished_ == 0; }
  bool HasNews() const ABSL_SHARED_LOCKS_REQUIRED(mutex_) { return closed_ || !lanes_.empty(); }
  // The next in turn that still has a share in the batch, else the end.
  Lanes::iterator NextLane(const OperationBatch& batch, const BatchLimits& limits)
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  mutable absl::Mutex mutex_;
  Lanes lanes_ ABSL_GUARDED_BY(mutex_);  // none is empty
  size_t unfinished_ ABSL_GUARDED_BY(mutex_) = 0;
  std::string last_served_ ABSL_GUARDED_BY(mutex_);
  bool closed_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_OPERATION_QUEUE_H_
