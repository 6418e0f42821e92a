// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "Eigen/LU"
#include "overtone/core/mapping/multi_robot_map_state.h"

namespace overtone {
namespace {

int RowOf(const MapProblem& problem, int mission, int64_t index) {
  return problem.first_pose[mission] + static_cast<int>(index);
}

}  // namespace

void MultiRobotMap::State::AddMissions(MapProblem& problem) const {
  PoseGraph& graph = problem.graph;
  graph.poses = {Rigid3d()};  // the world
  for (size_t m = 0; m < missions.size(); ++m) {
    const SnapshotMission& mission = missions[m];
    const int first = static_cast<int>(graph.poses.size());
    problem.first_pose.push_back(first);
    graph.poses.insert(graph.poses.end(), mission.map_from_body.begin(),
                       mission.map_from_body.end());
    for (int i = 1; i < static_cast<int>(mission.keyframes.size()); ++i) {
      const Motion& motion = motions[m][i];
      graph.edges.push_back({first + i - 1, first + i, motion.previous_from_this,
                             motion.covariance.inverse(), EdgeKind::kOdometry});
    }
  }
}

void MultiRobotMap::State::AddClosures(MapProblem& problem) const {
  problem.edge_of_closure.assign(closures.size(), -1);
  for (int k = 0; k < static_cast<int>(closures.size()); ++k) {
    const ClosureRecord& record = closures[k];
    if (!InPlay(k) || record.verdict == ClosureVerdict::kQuarantined) continue;
    const LoopCandidate& candidate = record.candidate;
    problem.edge_of_closure[k] = static_cast<int>(problem.graph.edges.size());
    // A forced closure counts as odometry does: nothing may switch it off.
    const EdgeKind kind = record.verdict == ClosureVerdict::kForcedByOperator
                              ? EdgeKind::kOdometry
                              : EdgeKind::kLoopClosure;
    problem.graph.edges.push_back({RowOf(problem, PositionOf(candidate.from), candidate.from.index),
                                   RowOf(problem, PositionOf(candidate.to), candidate.to.index),
                                   candidate.from_tform_to, InformationOf(candidate), kind});
  }
}

void MultiRobotMap::State::AddAbsolutes(MapProblem& problem) const {
  problem.edge_of_absolute.assign(absolutes.size(), -1);
  for (size_t k = 0; k < absolutes.size(); ++k) {
    const AbsoluteRecord& absolute = absolutes[k];
    if (FrameOf(absolute.node) != kWorld) continue;
    problem.edge_of_absolute[k] = static_cast<int>(problem.graph.edges.size());
    problem.graph.edges.push_back(
        {0, RowOf(problem, PositionOf(absolute.node), absolute.node.index), absolute.map_from_body,
         absolute.covariance.inverse(), EdgeKind::kLoopClosure});
  }
}

// A landmark of a frame is one point, whoever saw it there; a new one begins where it is seen.
void MultiRobotMap::State::AddSightings(MapProblem& problem) {
  std::map<std::pair<int, std::string>, int> number_of_landmark;
  problem.row_of_sighting.assign(sightings.size(), -1);
  for (size_t k = 0; k < sightings.size(); ++k) {
    const SightingRecord& sighting = sightings[k];
    if (sighting.pending) continue;
    const int frame = FrameOf(sighting.observer);
    PointSighting edge;
    edge.pose = RowOf(problem, PositionOf(sighting.observer), sighting.observer.index);
    edge.point_in_pose = sighting.point_in_body;
    edge.information = sighting.covariance.inverse();
    if (sighting.landmark.empty()) {
      if (FrameOf(sighting.target) != frame) continue;
      edge.target_pose = RowOf(problem, PositionOf(sighting.target), sighting.target.index);
      edge.point_in_target = sighting.point_in_target;
    } else {
      const std::pair<int, std::string> key(frame, sighting.landmark);
      const Eigen::Vector3d& position =
          landmarks.insert({key, *PoseOf(sighting.observer) * sighting.point_in_body})
              .first->second;
      const auto [number, fresh] =
          number_of_landmark.insert({key, static_cast<int>(problem.graph.landmarks.size())});
      if (fresh) {
        problem.graph.landmarks.push_back(position);
        problem.landmark_of.push_back(key);
      }
      edge.landmark = number->second;
    }
    problem.row_of_sighting[k] = static_cast<int>(problem.graph.sightings.size());
    problem.graph.sightings.push_back(edge);
  }
}

MapProblem MultiRobotMap::State::BuildProblem() {
  MapProblem problem;
  AddMissions(problem);
  AddClosures(problem);
  AddAbsolutes(problem);
  AddSightings(problem);
  return problem;
}

}  // namespace overtone
