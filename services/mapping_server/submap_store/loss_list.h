// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_LOSS_LIST_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_LOSS_LIST_H_

#include <string>
#include <vector>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"

namespace overtone {

// What a store lost to damage, a sentence each. Thread-safe.
class LossList {
 public:
  // Logs it. What is known already is not said again.
  void Add(const std::string& what);
  // From an earlier run: not logged.
  void Remember(const std::string& what);
  std::vector<std::string> All() const;

 private:
  bool IsNew(const std::string& what);

  mutable absl::Mutex mutex_;
  std::vector<std::string> losses_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_SUBMAP_STORE_LOSS_LIST_H_
