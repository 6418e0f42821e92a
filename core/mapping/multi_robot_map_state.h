// SPDX-License-Identifier: Apache-2.0
// What a MultiRobotMap holds, and the steps of one optimisation. Internal: three sources share it.
//   multi_robot_map.cc           what comes in, and what goes out as a snapshot
//   multi_robot_map_frames.cc    which missions share a frame
//   multi_robot_map_solution.cc  from poses and closures to a solved pose graph and back
#ifndef OVERTONE_CORE_MAPPING_MULTI_ROBOT_MAP_STATE_H_
#define OVERTONE_CORE_MAPPING_MULTI_ROBOT_MAP_STATE_H_

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "overtone/core/estimation/pose_graph_optimizer.h"
#include "overtone/core/mapping/frame_joining.h"
#include "overtone/core/mapping/multi_robot_map.h"

namespace overtone {

// Missions are in the order in which they came. Between two revisions `component` names a frame by
// its oldest mission's position, and poses of different frames have nothing to do with each other.
struct MultiRobotMap::State {
  MultiRobotMapOptions options;
  uint64_t map_epoch = 0;
  uint64_t revision = 0;
  bool dirty = false;
  std::vector<SnapshotMission> missions;
  std::map<MissionId, int> position_of;
  std::vector<SnapshotClosure> closures;
  std::map<std::pair<NodeId, NodeId>, std::vector<int>> closures_of_ends;

  void AppendKeyframes(const Submap& submap, SnapshotMission& mission);
  void InsertClosure(const LoopClosure& closure);
  // nullptr: not in the map yet.
  const Rigid3d* PoseOf(const NodeId& node) const;
  int FrameOf(const NodeId& node) const { return missions[position_of.at(node.mission)].component; }

  void ActivateClosures();
  // Whose ties may join frames: those of closures in use, or all that are not pending.
  enum class Joining { kInUse, kAll };
  // The closures whose measurements aligned the frames.
  std::vector<int> JoinFrames(Joining joining);
  // -1: no more frames to join.
  int JoinBestTiedFrames(Joining joining);
  FrameTie TieOf(const LoopClosure& closure) const;
  void MoveFrame(int frame, const Rigid3d& new_from_old, int new_frame);

  PoseGraph BuildPoseGraph(std::vector<int>* edge_of_closure) const;
  absl::StatusOr<PoseGraphResult> Solve(const PoseGraph& graph,
                                        const std::vector<double>& initial_weights) const;
  absl::StatusOr<PoseGraphResult> SolveWarm(const PoseGraph& graph,
                                            const std::vector<int>& edge_of_closure) const;
  bool DemotesBetweenMissions(const PoseGraphResult& result,
                              const std::vector<int>& edge_of_closure) const;
  void ReconsiderAlignments(PoseGraph graph, const std::vector<int>& edge_of_closure,
                            PoseGraphResult& result);
  double TruncatedCost(const PoseGraph& graph, const PoseGraphResult& result) const;
  void TakeResult(const PoseGraphResult& result, const std::vector<int>& edge_of_closure);
  void SplitFrames();
  std::shared_ptr<const MapSnapshot> Freeze(const PoseGraphResult& result);
};

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_MULTI_ROBOT_MAP_STATE_H_
