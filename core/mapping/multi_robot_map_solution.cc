// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "overtone/core/mapping/multi_robot_map_state.h"

namespace overtone {
namespace {

// A measurement below this weight no longer ties anything.
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

// Warm: from the verdicts of the previous revision; else everything is in use at first. From the
// problem's poses in both cases.
absl::StatusOr<PoseGraphResult> MultiRobotMap::State::Solve(const MapProblem& problem,
                                                            bool warm) const {
  PoseGraphOptimizerOptions solver;
  solver.loss = LossOf(options.robust);
  solver.closure_chi_square_limit = options.closure_chi_square_limit;
  solver.sighting_chi_square_limit = options.sighting_chi_square_limit;
  solver.max_iterations = options.max_iterations;
  solver.function_tolerance = kFunctionTolerance;
  solver.num_threads = options.num_threads;
  if (warm) {
    solver.initial_weights.assign(problem.graph.edges.size(), 1);
    for (size_t k = 0; k < closures.size(); ++k) {
      if (closures[k].verdict == ClosureVerdict::kDemotedByOptimiser) {
        solver.initial_weights[problem.edge_of_closure[k]] = 0;
      }
    }
    for (size_t k = 0; k < absolutes.size(); ++k) {
      const int edge = problem.edge_of_absolute[k];
      if (edge >= 0) solver.initial_weights[edge] = absolutes[k].weight > 0 ? 1 : 0;
    }
    solver.initial_sighting_weights.assign(problem.graph.sightings.size(), 1);
    for (size_t k = 0; k < sightings.size(); ++k) {
      const int row = problem.row_of_sighting[k];
      if (row >= 0) solver.initial_sighting_weights[row] = sightings[k].weight > 0 ? 1 : 0;
    }
  }
  return OptimizePoseGraph(problem.graph, solver);
}

// True when a closure that was in use up to now, or is new, loses its weight: one between missions,
// or one within a mission.
bool MultiRobotMap::State::Demotes(bool between_missions, const PoseGraphResult& result,
                                   const MapProblem& problem) const {
  for (size_t k = 0; k < closures.size(); ++k) {
    if (closures[k].verdict == ClosureVerdict::kAccepted &&
        BetweenMissions(closures[k]) == between_missions &&
        result.weights[problem.edge_of_closure[k]] < kDemotedBelowWeight) {
      return true;
    }
  }
  return false;
}

// What truncated least squares minimises over the estimate and the weights, doubled.
double MultiRobotMap::State::TruncatedCost(const MapProblem& problem,
                                           const PoseGraphResult& result) const {
  double cost = 0;
  for (size_t k = 0; k < problem.graph.edges.size(); ++k) {
    cost += problem.graph.edges[k].kind == EdgeKind::kOdometry
                ? result.chi_squares[k]
                : std::min(result.chi_squares[k], options.closure_chi_square_limit);
  }
  for (const double chi_square : result.sighting_chi_squares) {
    cost += std::min(chi_square, options.sighting_chi_square_limit);
  }
  return cost;
}

// A wrong closure that came first decided how two missions were aligned, or bent the one it is in,
// and every right one since has to prove itself against that. So when closures contradict each
// other, the missions are also aligned afresh by the votes of all closures, each mission with the
// shape that it has now or that odometry gave it; whichever start ends at the lower cost wins.
// Where the result already uses the closures that win the votes on the present shapes, it would
// only be found again.
void MultiRobotMap::State::Reconsider(Shapes shapes, MapProblem problem, PoseGraphResult& result) {
  const std::vector<SnapshotMission> current_missions = missions;
  const auto current_landmarks = landmarks;
  const auto give_up = [&] {
    missions = current_missions;
    landmarks = current_landmarks;
  };
  const int edges = static_cast<int>(problem.graph.edges.size());
  const int sightings_in_use = static_cast<int>(problem.graph.sightings.size());
  for (int m = 0; m < static_cast<int>(missions.size()); ++m) {
    if (missions[m].component != kWorld) missions[m].component = m;
  }
  if (shapes == Shapes::kOfOdometry) Unbend();
  const std::vector<int> aligning = JoinFrames(Joining::kAll);
  const bool in_use =
      shapes == Shapes::kPresent && std::all_of(aligning.begin(), aligning.end(), [&](int k) {
        return k < 0 || result.weights[problem.edge_of_closure[k]] >= kDemotedBelowWeight;
      });
  if (in_use) return give_up();
  problem = BuildProblem();
  // Only where the same measurements take part are the costs of the two starts comparable.
  if (static_cast<int>(problem.graph.edges.size()) != edges ||
      static_cast<int>(problem.graph.sightings.size()) != sightings_in_use) {
    return give_up();
  }
  const auto afresh = Solve(problem, /*warm=*/false);
  if (afresh.ok() && TruncatedCost(problem, *afresh) < TruncatedCost(problem, result)) {
    result = *afresh;
  } else {
    give_up();
  }
}

// Every mission as by odometry from where its first keyframe is.
void MultiRobotMap::State::Unbend() {
  for (SnapshotMission& mission : missions) {
    const Rigid3d map_from_mission =
        mission.map_from_body.front() * mission.keyframes.front().mission_from_body.Inverse();
    for (size_t i = 1; i < mission.keyframes.size(); ++i) {
      mission.map_from_body[i] = map_from_mission * mission.keyframes[i].mission_from_body;
    }
  }
}

void MultiRobotMap::State::TakeResult(const PoseGraphResult& result, const MapProblem& problem) {
  auto pose = result.poses.begin() + 1;  // after the world
  for (SnapshotMission& mission : missions) {
    std::copy_n(pose, mission.map_from_body.size(), mission.map_from_body.begin());
    pose += mission.map_from_body.size();
  }
  for (size_t i = 0; i < problem.landmark_of.size(); ++i) {
    landmarks[problem.landmark_of[i]] = result.landmarks[i];
  }
  for (size_t k = 0; k < closures.size(); ++k) {
    const int edge = problem.edge_of_closure[k];
    if (edge < 0) continue;
    ClosureRecord& record = closures[k];
    record.weight = result.weights[edge];
    record.chi_square = result.chi_squares[edge];
    if (record.verdict == ClosureVerdict::kForcedByOperator) continue;
    SetVerdict(record, record.weight < kDemotedBelowWeight ? ClosureVerdict::kDemotedByOptimiser
                                                           : ClosureVerdict::kAccepted);
  }
  for (size_t k = 0; k < absolutes.size(); ++k) {
    const int edge = problem.edge_of_absolute[k];
    if (edge >= 0) absolutes[k].weight = result.weights[edge];
  }
  for (size_t k = 0; k < sightings.size(); ++k) {
    const int row = problem.row_of_sighting[k];
    if (row >= 0) sightings[k].weight = result.sighting_weights[row];
  }
}

void MultiRobotMap::State::SetVerdict(ClosureRecord& record, ClosureVerdict verdict) const {
  if (record.verdict == verdict) return;
  record.verdict = verdict;
  record.since_revision = revision;
}

}  // namespace overtone
