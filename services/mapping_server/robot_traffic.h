// SPDX-License-Identifier: Apache-2.0
// What each robot of a map sends and is sent.
#ifndef OVERTONE_SERVICES_MAPPING_SERVER_ROBOT_TRAFFIC_H_
#define OVERTONE_SERVICES_MAPPING_SERVER_ROBOT_TRAFFIC_H_

#include <atomic>
#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "absl/base/thread_annotations.h"
#include "absl/synchronization/mutex.h"

namespace overtone {

// Since the map was opened. Counted by the robot's streams, read by anybody.
struct RobotCounters {
  std::atomic<int64_t> bytes_received{0};  // serialised messages of uploads
  std::atomic<int64_t> bytes_sent{0};      // likewise, of uploads and watches
  std::atomic<int> watches{0};             // open
  std::atomic<uint64_t> revision_sent{0};  // the newest one that went out on a watch
};

// Thread-safe.
class RobotTraffic {
 public:
  // At most so many robots are remembered.
  explicit RobotTraffic(size_t max_robots) : max_robots_(max_robots) {}

  // The same for the same robot. When there are too many, those that have no stream are forgotten;
  // one more than that is counted for itself alone and not told of.
  std::shared_ptr<RobotCounters> Of(const std::string& robot);
  // Null: nothing is known of it.
  std::shared_ptr<const RobotCounters> Find(const std::string& robot) const;

 private:
  const size_t max_robots_;
  mutable absl::Mutex mutex_;
  std::map<std::string, std::shared_ptr<RobotCounters>> robots_ ABSL_GUARDED_BY(mutex_);
};

}  // namespace overtone

#endif  // OVERTONE_SERVICES_MAPPING_SERVER_ROBOT_TRAFFIC_H_
