// SPDX-License-Identifier: Apache-2.0
// What waits for the writer, a lane for each robot: every lane gives one operation before any gives
// a second, so that one robot's backlog is not in the way of another.
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

using OperationBatch = std::vector<std::unique_ptr<StoreOperation>>;

// Thread-safe. Within a lane, first come, first served.
class OperationQueue {
 public:
  void Push(std::unique_ptr<StoreOperation> operation);
  // Waits until there is something; then what there is, up to the first operation at which
  // `max_bytes` are reached. Empty: closed, and nothing is left.
  OperationBatch Take(int64_t max_bytes);
  // So many of those taken are finished.
  void Finished(size_t count);
  bool empty() const;
  int64_t unfinished() const;
  // Waits until all that was pushed is finished.
  void AwaitFinished() const;
  // Take still gives what waits.
  void Close();

 private:
  bool AllFinished() const ABSL_SHARED_LOCKS_REQUIRED(mutex_) { return unfinished_ == 0; }
  bool HasNews() const ABSL_SHARED_LOCKS_REQUIRED(mutex_) { return closed_ || !lanes_.empty(); }
  // After the lane that was served last.
  std::map<std::string, std::deque<std::unique_ptr<StoreOperation>>>::iterator NextLane()
      ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  mutable absl::Mutex mutex_;
  // None is empty.
  std::map<std::string, std::deque<std::unique_ptr<StoreOperation>>> lanes_ ABSL_GUARDED_BY(mutex_);
  size_t unfinished_ ABSL_GUARDED_BY(mutex_) = 0;
  std::string last_served_ ABSL_GUARDED_BY(mutex_);
  bool closed_ ABSL_GUARDED_BY(mutex_) = false;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_OPERATION_QUEUE_H_
