// SPDX-License-Identifier: Apache-2.0
// The revisions that the dashboard saw, as frames of thinned positions (track_frame.h). Bounded in
// bytes: when it is full, every second of the older half goes. So it always reaches back to the
// first, the coarser the further.
#ifndef OVERTONE_SERVICES_DASHBOARD_REVISION_ARCHIVE_H_
#define OVERTONE_SERVICES_DASHBOARD_REVISION_ARCHIVE_H_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"
#include "absl/time/time.h"
#include "overtone/services/dashboard/map_view.h"

namespace overtone {

struct SeenRevision {
  uint64_t map_epoch = 0;
  uint64_t revision = 0;
  absl::Time published;
  std::shared_ptr<const std::string> frame;
};

// Thread-safe.
class RevisionArchive {
 public:
  // `max_nodes` of all missions together in each frame.
  RevisionArchive(size_t max_bytes, int64_t max_nodes)
      : max_bytes_(max_bytes), max_nodes_(max_nodes) {}

  // Of the revision in `view.summary`; one that is there already is not added again.
  void Add(const MapView& view);

  // Oldest first.
  std::vector<SeenRevision> List() const;
  // Null: not kept.
  std::shared_ptr<const std::string> Frame(uint64_t map_epoch, uint64_t revision) const;

 private:
  void MakeRoom() ABSL_EXCLUSIVE_LOCKS_REQUIRED(mutex_);

  const size_t max_bytes_;
  const int64_t max_nodes_;
  mutable absl::Mutex mutex_;
  std::vector<SeenRevision> seen_ ABSL_GUARDED_BY(mutex_);
  size_t bytes_ ABSL_GUARDED_BY(mutex_) = 0;
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_REVISION_ARCHIVE_H_
