// SPDX-License-Identifier: Apache-2.0
// The graph a robot receives: selected nodes of the optimised map, and sparse weighted edges or the
// rule for them.
#ifndef OVERTONE_CORE_GRAPH_MAP_GRAPH_H_
#define OVERTONE_CORE_GRAPH_MAP_GRAPH_H_

#include <cstdint>
#include <vector>

#include "overtone/core/common/ids.h"
#include "overtone/core/common/timestamp.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

struct MapNode {
  int64_t index = 0;  // keyframe index in its mission
  Timestamp stamp;    // robot clock
  Rigid3d map_from_body;
  bool submap_start = false;  // first kept node of a submap
  bool degenerate = false;
};

struct MapMission {
  MissionId id;
  // True: in the map's root component, poses are in the map frame. False: poses are in a frame of
  // the mission's own component and say nothing about where it is in the map.
  bool anchored = false;
  int component = 0;
  Rigid3d map_from_mission;
  std::vector<MapNode>
      nodes;  // index strictly increasing; the mission's last keyframe is always here
};

// Undirected, between positions in the concatenation of all missions' nodes; first < second, weight
// > 0.
struct MapEdge {
  int first = 0;
  int second = 0;
  double weight = 0;
};

struct MapGraph {
  uint64_t revision = 0;             // 0: nothing published yet
  uint64_t map_epoch = 0;            // changes when a map is restored or rolled back
  std::vector<MapMission> missions;  // sorted by id
  // Kron-reduced weights. Empty when the receiver rebuilds the edges by rule from the poses.
  std::vector<MapEdge> edges;

  int NumNodes() const {
    int count = 0;
    for (const MapMission& mission : missions) count += static_cast<int>(mission.nodes.size());
    return count;
  }
};

}  // namespace overtone

#endif  // OVERTONE_CORE_GRAPH_MAP_GRAPH_H_
