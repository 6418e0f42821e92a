// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_TESTS_FAULT_REVISION_WATCHER_H_
#define OVERTONE_TESTS_FAULT_REVISION_WATCHER_H_

#include <memory>
#include <string>
#include <thread>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "overtone/v1/mapping_service.grpc.pb.h"

namespace overtone {

// Watches a map over any number of streams, resumes where it stood, and keeps the books of what the
// server promises a watcher.
class RevisionWatcher {
 public:
  struct Books {
    uint64_t map_epoch = 0;  // the first
    uint64_t revision = 0;   // the newest of a graph
    int64_t graphs = 0;
    int64_t streams = 0;       // on which something was heard
    int64_t other_epochs = 0;  // frames of another epoch than the first
    int64_t went_back = 0;     // graphs not newer than the one before, heartbeats older
    int64_t wrong_deltas = 0;  // not from the revision that we hold
  };

  RevisionWatcher(const std::string& address, std::string map);
  ~RevisionWatcher();

  Books books() const;

 private:
  void Run();
  void RunStream(grpc::ClientContext* context);
  void Take(const v1::WatchGraphResponse& frame);

  const std::string map_;
  std::unique_ptr<v1::MappingService::Stub> stub_;
  mutable absl::Mutex mutex_;
  Books books_ ABSL_GUARDED_BY(mutex_);
  bool stopping_ ABSL_GUARDED_BY(mutex_) = false;
  grpc::ClientContext* context_ ABSL_GUARDED_BY(mutex_) = nullptr;  // of the stream that is open
  std::thread thread_;
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_FAULT_REVISION_WATCHER_H_
