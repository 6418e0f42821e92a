// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "overtone/core/common/status_macros.h"
#include "overtone/core/estimation/local_optimisation.h"
#include "overtone/core/mapping/multi_robot_map_state.h"

namespace overtone {
namespace {

// A measurement below this weight no longer ties anything.
constexpr double kDemotedBelowWeight = 1e-3;
constexpr double kFunctionTolerance = 1e-8;

// Rounds of joints and stretches; what the stretches may cost more than expected, as a share of the
// whole and beside it.
constexpr int kMaxRounds = 6;
constexpr double kSurpriseShare = 1e-7;
constexpr double kNoSurprise = 1e-10;
constexpr double kGrowthBetweenFullSolves = 1.25;

std::vector<double> ZeroOrOne(const std::vector<double>& weights) {
  std::vector<double> rounded;
  for (const double weight : weights) rounded.push_back(weight < kDemotedBelowWeight ? 0 : 1);
  return rounded;
}

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

PoseGraphOptimizerOptions MultiRobotMap::State::SolverOptions() const {
  PoseGraphOptimizerOptions solver;
  solver.loss = LossOf(options.robust);
  solver.closure_chi_square_limit = options.closure_chi_square_limit;
  solver.sighting_chi_square_limit = options.sighting_chi_square_limit;
  solver.max_iterations = options.max_iterations;
  solver.function_tolerance = kFunctionTolerance;
  solver.num_threads = options.num_threads;
  solver.give_up = give_up;
  return solver;
}

// The verdicts of the previous revision.
void MultiRobotMap::State::UseWeights(const MapProblem& problem,
                                      PoseGraphOptimizerOptions& solver) const {
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

// Where little has changed, only that; and now and then the whole, so that what a local solve may
// leave behind does not add up.
absl::StatusOr<PoseGraphResult> MultiRobotMap::State::SolveOnce(
    const PoseGraph& graph, const PoseGraphOptimizerOptions& solver, bool warm) {
  const auto size = static_cast<double>(graph.poses.size());
  if (warm && size <= kGrowthBetweenFullSolves * static_cast<double>(poses_at_full_solve)) {
    ASSIGN_OR_RETURN(std::optional<PoseGraphResult> local, OptimizeLocally(graph, solver));
    if (local.has_value()) return *std::move(local);
  }
  auto result = OptimizePoseGraph(graph, solver);
  if (result.ok() && warm) poses_at_full_solve = graph.poses.size();
  return result;
}

// Gives the missions the result's poses; what their motions then cost more than it expected, twice.
// The problem is linearised there.
double MultiRobotMap::State::MoveMissions(const PoseGraphResult& result, MapProblem& problem) {
  double surprise = 0;
  for (size_t m = 0; m < missions.size(); ++m) {
    surprise +=
        chains[m].Move(&result.poses[problem.first_pose[m]], motions[m], missions[m].map_from_body);
    int edge = problem.first_edge[m];
    for (const MissionChain::Stretch& stretch : chains[m].stretches()) {
      problem.graph.edges[edge].from_tform_to = stretch.edge.first_from_last;
      problem.graph.edges[edge].information = stretch.edge.information;
      ++edge;
    }
  }
  problem.graph.poses = result.poses;
  problem.graph.landmarks = result.landmarks;
  return surprise;
}

// Warm: from the verdicts of the previous revision; else everything is in use at first. From the
// problem's poses in both cases. The missions' poses go along: each round solves for the joints
// with an edge for each stretch of odometry, moves the stretches, and ends when they cost what
// their edges said.
absl::StatusOr<PoseGraphResult> MultiRobotMap::State::Solve(MapProblem& problem, bool warm) {
  PoseGraphOptimizerOptions solver = SolverOptions();
  if (warm) UseWeights(problem, solver);
  ASSIGN_OR_RETURN(PoseGraphResult result, SolveOnce(problem.graph, solver, warm));
  const double initial_cost = result.initial_cost;
  for (int round = 1; round < kMaxRounds; ++round) {
    if (MoveMissions(result, problem) <= kSurpriseShare * result.final_cost + kNoSurprise) break;
    if (IsGraduated(solver.loss)) {
      solver.initial_weights = ZeroOrOne(result.weights);
      solver.initial_sighting_weights = ZeroOrOne(result.sighting_weights);
    }
    const double seconds = result.seconds;
    ASSIGN_OR_RETURN(result, SolveOnce(problem.graph, solver, /*warm=*/true));
    result.seconds += seconds;
    if (round + 1 == kMaxRounds) MoveMissions(result, problem);
  }
  result.initial_cost = initial_cost;
  return result;
}

absl::StatusOr<PoseGraphResult> MultiRobotMap::State::SolveAndReconsider(MapProblem& problem) {
  ASSIGN_OR_RETURN(PoseGraphResult result, Solve(problem, /*warm=*/true));
  if (Demotes(/*between_missions=*/true, result, problem)) {
    RETURN_IF_ERROR(Reconsider(Shapes::kPresent, problem, result));
  }
  if (Demotes(/*between_missions=*/false, result, problem)) {
    RETURN_IF_ERROR(Reconsider(Shapes::kOfOdometry, problem, result));
  }
  return result;
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
absl::Status MultiRobotMap::State::Reconsider(Shapes shapes, MapProblem problem,
                                              PoseGraphResult& result) {
  const Estimate current = Save();
  const std::vector<MissionChain> current_chains = chains;
  const auto stay = [&] {
    GoBack(current);
    chains = current_chains;
    return absl::OkStatus();
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
  if (in_use) return stay();
  problem = BuildProblem();
  // Only where the same measurements take part are the costs of the two starts comparable.
  if (static_cast<int>(problem.graph.edges.size()) != edges ||
      static_cast<int>(problem.graph.sightings.size()) != sightings_in_use) {
    return stay();
  }
  const auto afresh = Solve(problem, /*warm=*/false);
  if (absl::IsCancelled(afresh.status())) return afresh.status();
  if (!afresh.ok() || TruncatedCost(problem, *afresh) >= TruncatedCost(problem, result)) {
    return stay();
  }
  result = *afresh;
  return absl::OkStatus();
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
  for (MissionChain& chain : chains) chain.Forget(0);
}

MultiRobotMap::State::Estimate MultiRobotMap::State::Save() const {
  Estimate estimate;
  for (const SnapshotMission& mission : missions) {
    estimate.components.push_back(mission.component);
    estimate.poses.push_back(mission.map_from_body);
  }
  estimate.landmarks = landmarks;
  return estimate;
}

void MultiRobotMap::State::GoBack(Estimate estimate) {
  for (size_t m = 0; m < missions.size(); ++m) {
    missions[m].component = estimate.components[m];
    missions[m].map_from_body = std::move(estimate.poses[m]);
    chains[m].Forget(0);
  }
  landmarks = std::move(estimate.landmarks);
}

void MultiRobotMap::State::TakeResult(const PoseGraphResult& result, const MapProblem& problem) {
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
