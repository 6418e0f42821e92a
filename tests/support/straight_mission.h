// SPDX-License-Identifier: Apache-2.0
// A mission along the x axis, one keyframe per metre and second, as submap, as graph and as the
// onboard estimate.
#ifndef OVERTONE_TESTS_SUPPORT_STRAIGHT_MISSION_H_
#define OVERTONE_TESTS_SUPPORT_STRAIGHT_MISSION_H_

#include <cmath>
#include <memory>
#include <random>
#include <utility>
#include <vector>

#include "overtone/client/host_estimator.h"
#include "overtone/core/graph/map_graph.h"
#include "overtone/core/graph/submap.h"

namespace overtone {

inline MissionId TestMission() { return {"robot_a", "run_1"}; }

inline Timestamp StampOf(int64_t index) { return {(index + 1) * 1'000'000'000}; }

inline Submap StraightSubmap(int64_t sequence, int keyframes_per_submap = 10) {
  Submap submap;
  submap.sequence = sequence;
  submap.first_index = sequence * keyframes_per_submap;
  for (int i = 0; i < keyframes_per_submap; ++i) {
    Keyframe keyframe;
    const int64_t index = submap.first_index + i;
    keyframe.stamp = StampOf(index);
    keyframe.mission_from_body.translation.x() = static_cast<double>(index);
    keyframe.motion_covariance = 1e-4 * Matrix6d::Identity();
    submap.keyframes.push_back(keyframe);
  }
  return submap;
}

// A cloud for each of the submap's first keyframes, no two alike.
inline Submap WithClouds(Submap submap, int num_clouds, int points_per_cloud = 50) {
  for (int64_t index = submap.first_index; index < submap.first_index + num_clouds; ++index) {
    std::mt19937 random(static_cast<unsigned>(index));
    std::uniform_real_distribution<float> uniform(-20, 20);
    auto cloud = std::make_shared<PointCloud>();
    for (int i = 0; i < points_per_cloud; ++i) {
      cloud->points.emplace_back(uniform(random), uniform(random), uniform(random));
    }
    submap.clouds.push_back({index, std::move(cloud)});
  }
  return submap;
}

inline LoopClosure ClosureBetween(int64_t from, int64_t to) {
  LoopClosure closure;
  closure.from = {TestMission(), from};
  closure.to = {TestMission(), to};
  closure.from_tform_to.translation.x() = static_cast<double>(to - from);
  closure.covariance = 1e-4 * Matrix6d::Identity();
  return closure;
}

inline MapGraph StraightGraph(int num_nodes, uint64_t revision, uint64_t map_epoch = 1) {
  MapGraph graph;
  graph.revision = revision;
  graph.map_epoch = map_epoch;
  MapMission mission;
  mission.id = TestMission();
  mission.anchored = true;
  for (int64_t i = 0; i < num_nodes; ++i) {
    MapNode node;
    node.index = i;
    node.stamp = StampOf(i);
    node.map_from_body.translation.x() = static_cast<double>(i);
    node.submap_start = i % 10 == 0;
    mission.nodes.push_back(node);
  }
  graph.missions.push_back(mission);
  return graph;
}

// The onboard estimate: straight too, but bent sideways by `bend_m` over the second half.
inline std::vector<OnboardPose> BentTrajectory(int num_poses, double bend_m) {
  std::vector<OnboardPose> trajectory(num_poses);
  for (int i = 0; i < num_poses; ++i) {
    trajectory[i].index = i;
    trajectory[i].stamp = StampOf(i);
    trajectory[i].estimate_from_body.translation.x() = i;
    const double along = std::max(0.0, (2.0 * i) / num_poses - 1.0);
    trajectory[i].estimate_from_body.translation.y() = bend_m * along;
  }
  return trajectory;
}

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_STRAIGHT_MISSION_H_
