// SPDX-License-Identifier: Apache-2.0
// Names of maps, robots, missions and keyframes.
#ifndef OVERTONE_CORE_COMMON_IDS_H_
#define OVERTONE_CORE_COMMON_IDS_H_

#include <cstdint>
#include <string>
#include <tuple>
#include <utility>

#include "absl/status/status.h"
#include "absl/strings/string_view.h"

namespace overtone {

// Ok when `id` matches [a-z0-9][a-z0-9_-]{0,62}, the rule for map, robot and mission ids.
// InvalidArgument naming `field` and what is wrong otherwise.
absl::Status ValidateId(absl::string_view id, absl::string_view field);

// One run of one robot with one odometry frame.
struct MissionId {
  std::string robot;
  std::string mission;

  friend bool operator==(const MissionId& a, const MissionId& b) {
    return a.robot == b.robot && a.mission == b.mission;
  }
  friend bool operator!=(const MissionId& a, const MissionId& b) { return !(a == b); }
  friend bool operator<(const MissionId& a, const MissionId& b) {
    return std::tie(a.robot, a.mission) < std::tie(b.robot, b.mission);
  }
  template <typename H>
  friend H AbslHashValue(H h, const MissionId& id) {
    return H::combine(std::move(h), id.robot, id.mission);
  }
};

// "robot/mission"
std::string ToString(const MissionId& id);

// One keyframe of a mission. `index` counts from 0 and is never renumbered.
struct NodeId {
  MissionId mission;
  int64_t index = 0;

  friend bool operator==(const NodeId& a, const NodeId& b) {
    return a.index == b.index && a.mission == b.mission;
  }
  friend bool operator!=(const NodeId& a, const NodeId& b) { return !(a == b); }
  friend bool operator<(const NodeId& a, const NodeId& b) {
    return std::tie(a.mission, a.index) < std::tie(b.mission, b.index);
  }
  template <typename H>
  friend H AbslHashValue(H h, const NodeId& id) {
    return H::combine(std::move(h), id.mission, id.index);
  }
};

// "robot/mission:index"
std::string ToString(const NodeId& id);

}  // namespace overtone

#endif  // OVERTONE_CORE_COMMON_IDS_H_
