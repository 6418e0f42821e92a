// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "Eigen/LU"
#include "overtone/core/mapping/multi_robot_map_state.h"

namespace overtone {

bool MultiRobotMap::State::TakesPart(int closure) const {
  return InPlay(closure) && closures[closure].verdict != ClosureVerdict::kQuarantined;
}

// The keyframes that AddClosures, AddAbsolutes and AddSightings refer to.
void MultiRobotMap::State::FindJoints() {
  std::vector<std::vector<int>> joints(missions.size(), {0});
  const auto add = [&](const NodeId& node) {
    joints[PositionOf(node)].push_back(static_cast<int>(node.index));
  };
  for (int k = 0; k < static_cast<int>(closures.size()); ++k) {
    if (!TakesPart(k)) continue;
    add(closures[k].candidate.from);
    add(closures[k].candidate.to);
  }
  for (const AbsoluteRecord& absolute : absolutes) {
    if (FrameOf(absolute.node) == kWorld) add(absolute.node);
  }
  for (const SightingRecord& sighting : sightings) {
    if (sighting.pending) continue;
    add(sighting.observer);
    if (sighting.landmark.empty()) add(sighting.target);
  }
  for (size_t m = 0; m < missions.size(); ++m) {
    std::sort(joints[m].begin(), joints[m].end());
    joints[m].erase(std::unique(joints[m].begin(), joints[m].end()), joints[m].end());
    chains[m].SetJoints(std::move(joints[m]), motions[m], missions[m].map_from_body);
  }
}

int MultiRobotMap::State::RowOf(const MapProblem& problem, const NodeId& node) const {
  const int mission = PositionOf(node);
  return problem.first_pose[mission] + chains[mission].JointOf(static_cast<int>(node.index));
}

void MultiRobotMap::State::AddMissions(MapProblem& problem) const {
  PoseGraph& graph = problem.graph;
  graph.poses = {Rigid3d()};  // the world
  for (size_t m = 0; m < missions.size(); ++m) {
    int row = static_cast<int>(graph.poses.size());
    problem.first_pose.push_back(row);
    problem.first_edge.push_back(static_cast<int>(graph.edges.size()));
    for (const int joint : chains[m].joints()) {
      graph.poses.push_back(missions[m].map_from_body[joint]);
    }
    for (const MissionChain::Stretch& stretch : chains[m].stretches()) {
      graph.edges.push_back({row, row + 1, stretch.edge.first_from_last, stretch.edge.information,
                             EdgeKind::kOdometry});
      ++row;
    }
  }
}

void MultiRobotMap::State::AddClosures(MapProblem& problem) const {
  problem.edge_of_closure.assign(closures.size(), -1);
  for (int k = 0; k < static_cast<int>(closures.size()); ++k) {
    const ClosureRecord& record = closures[k];
    if (!TakesPart(k)) continue;
    const LoopCandidate& candidate = record.candidate;
    problem.edge_of_closure[k] = static_cast<int>(problem.graph.edges.size());
    // A forced closure counts as odometry does: nothing may switch it off.
    const EdgeKind kind = record.verdict == ClosureVerdict::kForcedByOperator
                              ? EdgeKind::kOdometry
                              : EdgeKind::kLoopClosure;
    problem.graph.edges.push_back({RowOf(problem, candidate.from), RowOf(problem, candidate.to),
                                   candidate.from_tform_to, InformationOf(candidate), kind});
  }
}

void MultiRobotMap::State::AddAbsolutes(MapProblem& problem) const {
  problem.edge_of_absolute.assign(absolutes.size(), -1);
  for (size_t k = 0; k < absolutes.size(); ++k) {
    const AbsoluteRecord& absolute = absolutes[k];
    if (FrameOf(absolute.node) != kWorld) continue;
    problem.edge_of_absolute[k] = static_cast<int>(problem.graph.edges.size());
    problem.graph.edges.push_back({0, RowOf(problem, absolute.node), absolute.map_from_body,
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
    edge.pose = RowOf(problem, sighting.observer);
    edge.point_in_pose = sighting.point_in_body;
    edge.information = sighting.covariance.inverse();
    if (sighting.landmark.empty()) {
      if (FrameOf(sighting.target) != frame) continue;
      edge.target_pose = RowOf(problem, sighting.target);
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
  FindJoints();
  MapProblem problem;
  AddMissions(problem);
  AddClosures(problem);
  AddAbsolutes(problem);
  AddSightings(problem);
  return problem;
}

}  // namespace overtone
