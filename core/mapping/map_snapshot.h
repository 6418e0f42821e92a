// SPDX-License-Identifier: Apache-2.0
// An optimised map, frozen. Everyone but the mapping thread reads snapshots and never the map
// itself.
#ifndef OVERTONE_CORE_MAPPING_MAP_SNAPSHOT_H_
#define OVERTONE_CORE_MAPPING_MAP_SNAPSHOT_H_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "absl/strings/string_view.h"
#include "overtone/core/common/ids.h"
#include "overtone/core/graph/submap.h"

namespace overtone {

enum class ClosureVerdict {
  kPending,             // an end is not in the map yet
  kAccepted,            // used, at full or nearly full weight
  kDemotedByOptimiser,  // contradicts the rest of the map; its weight went to zero
};

absl::string_view ToString(
    ClosureVerdict verdict);  // "pending", "accepted", "demoted_by_optimiser"

struct SnapshotClosure {
  LoopClosure closure;
  ClosureVerdict verdict = ClosureVerdict::kPending;
  double weight = 0;      // [0, 1], of the robust optimisation
  double chi_square = 0;  // r^T Omega r after it, 6 degrees of freedom
};

struct SnapshotMission {
  MissionId id;
  bool anchored = false;
  int component = 0;  // 0 is the root component, the one of the map's first mission
  Rigid3d
      map_from_mission;  // best rigid alignment of the odometry frame: that of the last keyframe
  std::vector<Keyframe> keyframes;     // as uploaded
  std::vector<Rigid3d> map_from_body;  // as optimised, one for each keyframe
  std::vector<int64_t> submap_starts;  // first keyframe index of each submap, increasing
};

struct MapSnapshot {
  uint64_t revision = 0;
  uint64_t map_epoch = 0;
  std::vector<SnapshotMission> missions;  // sorted by id
  std::vector<SnapshotClosure> closures;  // in the order received
  double initial_cost = 0;                // 1/2 sum of squared whitened residuals
  double final_cost = 0;
  bool converged = true;
  double optimisation_s = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_MAP_SNAPSHOT_H_
