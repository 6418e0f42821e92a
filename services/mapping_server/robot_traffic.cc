// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/robot_traffic.h"

#include <iterator>

namespace overtone {

std::shared_ptr<RobotCounters> RobotTraffic::Of(const std::string& robot) {
  absl::MutexLock lock(&mutex_);
  const auto it = robots_.find(robot);
  if (it != robots_.end()) return it->second;
  if (robots_.size() >= max_robots_) {
    for (auto known = robots_.begin(); known != robots_.end();) {
      known = known->second.use_count() == 1 ? robots_.erase(known) : std::next(known);
    }
  }
  auto counters = std::make_shared<RobotCounters>();
  if (robots_.size() < max_robots_) robots_.emplace(robot, counters);
  return counters;
}

std::shared_ptr<const RobotCounters> RobotTraffic::Find(const std::string& robot) const {
  absl::MutexLock lock(&mutex_);
  const auto it = robots_.find(robot);
  return it == robots_.end() ? nullptr : it->second;
}

}  // namespace overtone
