// SPDX-License-Identifier: Apache-2.0
// Blobs by their digest, as a store gives them.
#ifndef OVERTONE_TESTS_SERVICES_MAPPING_SERVER_BLOB_SHELF_H_
#define OVERTONE_TESTS_SERVICES_MAPPING_SERVER_BLOB_SHELF_H_

#include <map>
#include <memory>
#include <string>
#include <utility>

#include "absl/base/thread_annotations.h"
#include "absl/status/statusor.h"
#include "absl/synchronization/mutex.h"
#include "overtone/proto/conversion/sha256.h"

namespace overtone {

// Thread-safe.
class BlobShelf {
 public:
  using Blob = std::shared_ptr<const std::string>;

  // Its digest.
  std::string Put(Blob blob) {
    std::string sha256 = Sha256(*blob);
    absl::MutexLock lock(&mutex_);
    blobs_[sha256] = std::move(blob);
    return sha256;
  }
  absl::StatusOr<Blob> Get(const std::string& sha256) const {
    absl::MutexLock lock(&mutex_);
    const auto found = blobs_.find(sha256);
    if (found == blobs_.end()) return absl::NotFoundError("blob: not there");
    return found->second;
  }
  void Clear() {
    absl::MutexLock lock(&mutex_);
    blobs_.clear();
  }

 private:
  mutable absl::Mutex mutex_;
  std::map<std::string, Blob> blobs_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_SERVICES_MAPPING_SERVER_BLOB_SHELF_H_
