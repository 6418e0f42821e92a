// SPDX-License-Identifier: Apache-2.0
// An optimised map, frozen. Everyone but the mapping thread reads snapshots and never the map
// itself.
#ifndef OVERTONE_CORE_MAPPING_MAP_SNAPSHOT_H_
#define OVERTONE_CORE_MAPPING_MAP_SNAPSHOT_H_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "overtone/core/common/ids.h"
#include "overtone/core/mapping/keyframe_blocks.h"
#include "overtone/core/mapping/loop_closure.h"

namespace overtone {

struct SnapshotMission {
  MissionId id;
  bool anchored = false;
  // 0 is the root component: the one with absolute poses, and where there are none, the one of the
  // map's first mission.
  int component = 0;
  Rigid3d
      map_from_mission;  // best rigid alignment of the odometry frame: that of the last keyframe
  KeyframeBlocks keyframes;            // as uploaded; shared by all snapshots
  std::vector<Rigid3d> map_from_body;  // as optimised, one for each keyframe
  std::vector<int64_t> submap_starts;  // first keyframe index of each submap, increasing
};

struct SnapshotLandmark {
  std::string id;
  int component = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // in the frame of its component
  int sightings = 0;                                   // in use
};

struct MapSnapshot {
  uint64_t revision = 0;
  uint64_t map_epoch = 0;
  std::vector<SnapshotMission> missions;  // sorted by id
  std::vector<ClosureRecord> closures;    // every candidate, in the order received
  std::vector<SnapshotLandmark> landmarks;
  int sightings = 0;          // of landmarks, robots and absolute poses, that are in use
  int sightings_demoted = 0;  // that contradict the map
  double initial_cost = 0;    // 1/2 sum of squared whitened residuals
  double final_cost = 0;
  bool converged = true;
  double optimisation_s = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_MAP_SNAPSHOT_H_
