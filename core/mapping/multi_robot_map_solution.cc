// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "Eigen/LU"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/estimation/pose_graph_optimizer.h"
#include "overtone/core/mapping/multi_robot_map_state.h"

namespace overtone {
namespace {

// A closure below this weight no longer ties anything.
constexpr double kDemotedBelowWeight = 1e-3;
constexpr double kFunctionTolerance = 1e-8;

RobustLoss LossOf(MultiRobotMapOptions::Robust robust) {
  switch (robust) {
    case MultiRobotMapOptions::Robust::kHuber:
      return RobustLoss::kHuber;
    case MultiRobotMapOptions::Robust::kGnc:
      return RobustLoss::kTruncatedLeastSquares;
    case MultiRobotMapOptions::Robust::kNone:
      break;
  }
  return RobustLoss::kNone;
}

}  // namespace

// edge_of_closure: -1 for pending ones.
PoseGraph MultiRobotMap::State::BuildPoseGraph(std::vector<int>* edge_of_closure) const {
  PoseGraph graph;
  std::vector<int> first_pose;  // of each mission
  for (const SnapshotMission& mission : missions) {
    const int first = static_cast<int>(graph.poses.size());
    first_pose.push_back(first);
    graph.poses.insert(graph.poses.end(), mission.map_from_body.begin(),
                       mission.map_from_body.end());
    for (int i = 1; i < static_cast<int>(mission.keyframes.size()); ++i) {
      const Keyframe& keyframe = mission.keyframes[i];
      graph.edges.push_back(
          {first + i - 1, first + i,
           mission.keyframes[i - 1].mission_from_body.Inverse() * keyframe.mission_from_body,
           keyframe.motion_covariance.inverse(), EdgeKind::kOdometry});
    }
  }
  const auto position = [&](const NodeId& node) {
    return first_pose[position_of.at(node.mission)] + static_cast<int>(node.index);
  };
  edge_of_closure->assign(closures.size(), -1);
  for (size_t k = 0; k < closures.size(); ++k) {
    if (closures[k].verdict == ClosureVerdict::kPending) continue;
    const LoopClosure& closure = closures[k].closure;
    (*edge_of_closure)[k] = static_cast<int>(graph.edges.size());
    graph.edges.push_back({position(closure.from), position(closure.to), closure.from_tform_to,
                           closure.covariance.inverse(), EdgeKind::kLoopClosure});
  }
  return graph;
}

absl::StatusOr<PoseGraphResult> MultiRobotMap::State::Solve(
    const PoseGraph& graph, const std::vector<double>& initial_weights) const {
  PoseGraphOptimizerOptions solver;
  solver.loss = LossOf(options.robust);
  solver.closure_chi_square_limit = options.closure_chi_square_limit;
  solver.initial_weights = initial_weights;
  solver.max_iterations = options.max_iterations;
  solver.function_tolerance = kFunctionTolerance;
  solver.num_threads = options.num_threads;
  return OptimizePoseGraph(graph, solver);
}

// From the poses and verdicts of the previous revision.
absl::StatusOr<PoseGraphResult> MultiRobotMap::State::SolveWarm(
    const PoseGraph& graph, const std::vector<int>& edge_of_closure) const {
  std::vector<double> weights(graph.edges.size(), 1);
  for (size_t k = 0; k < closures.size(); ++k) {
    if (closures[k].verdict == ClosureVerdict::kDemotedByOptimiser) weights[edge_of_closure[k]] = 0;
  }
  return Solve(graph, weights);
}

// True when a closure between missions that was in use up to now loses its weight.
bool MultiRobotMap::State::DemotesBetweenMissions(const PoseGraphResult& result,
                                                  const std::vector<int>& edge_of_closure) const {
  for (size_t k = 0; k < closures.size(); ++k) {
    const SnapshotClosure& entry = closures[k];
    if (entry.verdict == ClosureVerdict::kAccepted &&
        result.weights[edge_of_closure[k]] < kDemotedBelowWeight &&
        entry.closure.from.mission != entry.closure.to.mission) {
      return true;
    }
  }
  return false;
}

// What truncated least squares minimises over poses and weights, doubled.
double MultiRobotMap::State::TruncatedCost(const PoseGraph& graph,
                                           const PoseGraphResult& result) const {
  double cost = 0;
  for (size_t k = 0; k < graph.edges.size(); ++k) {
    cost += graph.edges[k].kind == EdgeKind::kOdometry
                ? result.chi_squares[k]
                : std::min(result.chi_squares[k], options.closure_chi_square_limit);
  }
  return cost;
}

// A wrong closure that came first decided how two missions were aligned, and every right one since
// has to prove itself against that. So when closures between missions contradict each other, the
// missions, each as it is now, are also aligned afresh by the votes of all closures; whichever
// start ends at the lower cost wins. Where the result already uses the closures that win the votes,
// it would only be found again.
void MultiRobotMap::State::ReconsiderAlignments(PoseGraph graph,
                                                const std::vector<int>& edge_of_closure,
                                                PoseGraphResult& result) {
  const std::vector<SnapshotMission> current = missions;
  for (int m = 0; m < static_cast<int>(missions.size()); ++m) missions[m].component = m;
  const std::vector<int> aligning = JoinFrames(Joining::kAll);
  const bool in_use = std::all_of(aligning.begin(), aligning.end(), [&](int k) {
    return result.weights[edge_of_closure[k]] >= kDemotedBelowWeight;
  });
  if (in_use) {
    missions = current;
    return;
  }
  graph.poses.clear();
  for (const SnapshotMission& mission : missions) {
    graph.poses.insert(graph.poses.end(), mission.map_from_body.begin(),
                       mission.map_from_body.end());
  }
  const auto afresh = Solve(graph, /*initial_weights=*/{});
  if (afresh.ok() && TruncatedCost(graph, *afresh) < TruncatedCost(graph, result)) {
    result = *afresh;
  } else {
    missions = current;
  }
}

void MultiRobotMap::State::TakeResult(const PoseGraphResult& result,
                                      const std::vector<int>& edge_of_closure) {
  auto pose = result.poses.begin();
  for (SnapshotMission& mission : missions) {
    std::copy_n(pose, mission.map_from_body.size(), mission.map_from_body.begin());
    pose += mission.map_from_body.size();
  }
  for (size_t k = 0; k < closures.size(); ++k) {
    if (edge_of_closure[k] < 0) continue;
    SnapshotClosure& entry = closures[k];
    entry.weight = result.weights[edge_of_closure[k]];
    entry.chi_square = result.chi_squares[edge_of_closure[k]];
    entry.verdict = entry.weight < kDemotedBelowWeight ? ClosureVerdict::kDemotedByOptimiser
                                                       : ClosureVerdict::kAccepted;
  }
}

}  // namespace overtone
