// SPDX-License-Identifier: Apache-2.0
// A snapshot as one plain pose graph, for batch solvers.
#ifndef OVERTONE_TESTS_SUPPORT_FULL_GRAPH_H_
#define OVERTONE_TESTS_SUPPORT_FULL_GRAPH_H_

#include <algorithm>
#include <map>

#include "Eigen/LU"
#include "overtone/core/graph/pose_graph.h"
#include "overtone/core/mapping/map_snapshot.h"

namespace overtone {

// Every keyframe a pose, every motion an edge, closures in use; poses as in `before`, those that
// came since by odometry.
inline PoseGraph FullGraph(const MapSnapshot& before, const MapSnapshot& after) {
  PoseGraph graph;
  std::map<MissionId, int64_t> first_pose;
  for (const SnapshotMission& mission : after.missions) {
    first_pose[mission.id] = static_cast<int64_t>(graph.poses.size());
    const auto old = std::find_if(before.missions.begin(), before.missions.end(),
                                  [&](const auto& other) { return other.id == mission.id; });
    for (int i = 0; i < static_cast<int>(mission.keyframes.size()); ++i) {
      const int row = static_cast<int>(graph.poses.size());
      Rigid3d motion;
      if (i > 0) {
        motion = mission.keyframes[i - 1].mission_from_body.Inverse() *
                 mission.keyframes[i].mission_from_body;
        graph.edges.push_back({row - 1, row, motion,
                               mission.keyframes[i].motion_covariance.inverse(),
                               EdgeKind::kOdometry});
      }
      const bool known =
          old != before.missions.end() && i < static_cast<int>(old->map_from_body.size());
      graph.poses.push_back(known    ? old->map_from_body[i]
                            : i == 0 ? mission.map_from_body[0]
                                     : graph.poses.back() * motion);
    }
  }
  for (const ClosureRecord& record : after.closures) {
    if (!InUse(record.verdict)) continue;
    const LoopCandidate& closure = record.candidate;
    graph.edges.push_back({static_cast<int>(first_pose[closure.from.mission] + closure.from.index),
                           static_cast<int>(first_pose[closure.to.mission] + closure.to.index),
                           closure.from_tform_to, InformationOf(closure), EdgeKind::kLoopClosure});
  }
  return graph;
}

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_FULL_GRAPH_H_
