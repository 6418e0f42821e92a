// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/multi_robot_map.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "Eigen/LU"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/estimation/connected_components.h"
#include "overtone/core/estimation/pose_graph_optimizer.h"
#include "overtone/core/mapping/frame_joining.h"
#include "overtone/core/mapping/submap_check.h"

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

bool SameMeasurement(const LoopClosure& a, const LoopClosure& b) {
  return a.from_tform_to.rotation.coeffs() == b.from_tform_to.rotation.coeffs() &&
         a.from_tform_to.translation == b.from_tform_to.translation && a.covariance == b.covariance;
}

}  // namespace

absl::Status MultiRobotMapOptions::Validate() const {
  if (!(closure_chi_square_limit > 0) || !std::isfinite(closure_chi_square_limit)) {
    return absl::InvalidArgumentError("closure_chi_square_limit must be positive and finite");
  }
  if (max_iterations < 1) return absl::InvalidArgumentError("max_iterations must be at least 1");
  if (num_threads < 1) return absl::InvalidArgumentError("num_threads must be at least 1");
  return absl::OkStatus();
}

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
  void JoinFrames(Joining joining);
  bool JoinBestTiedFrames(Joining joining);
  FrameTie TieOf(const LoopClosure& closure) const;
  void MoveFrame(int frame, const Rigid3d& new_from_old, int new_frame);

  PoseGraph BuildPoseGraph(std::vector<int>* edge_of_closure) const;
  absl::StatusOr<PoseGraphResult> Solve(const PoseGraph& graph,
                                        const std::vector<double>& initial_weights) const;
  absl::StatusOr<PoseGraphResult> SolveWarm(const PoseGraph& graph,
                                            const std::vector<int>& edge_of_closure) const;
  bool DemotesBetweenMissions(const PoseGraphResult& result,
                              const std::vector<int>& edge_of_closure) const;
  void ReconsiderAlignments(PoseGraph graph, PoseGraphResult& result);
  double TruncatedCost(const PoseGraph& graph, const PoseGraphResult& result) const;
  void TakeResult(const PoseGraphResult& result, const std::vector<int>& edge_of_closure);
  void SplitFrames();
  std::shared_ptr<const MapSnapshot> Freeze(const PoseGraphResult& result);
};

// New keyframes follow from the mission's last optimised pose by odometry.
void MultiRobotMap::State::AppendKeyframes(const Submap& submap, SnapshotMission& mission) {
  mission.submap_starts.push_back(submap.first_index);
  for (const Keyframe& keyframe : submap.keyframes) {
    Rigid3d map_from_mission;
    if (!mission.keyframes.empty()) {
      map_from_mission =
          mission.map_from_body.back() * mission.keyframes.back().mission_from_body.Inverse();
    }
    mission.map_from_body.push_back(map_from_mission * keyframe.mission_from_body);
    mission.keyframes.push_back(keyframe);
  }
}

void MultiRobotMap::State::InsertClosure(const LoopClosure& closure) {
  std::vector<int>& same_ends = closures_of_ends[{closure.from, closure.to}];
  for (const int k : same_ends) {
    if (SameMeasurement(closures[k].closure, closure)) return;
  }
  same_ends.push_back(static_cast<int>(closures.size()));
  closures.emplace_back().closure = closure;
  dirty = true;
}

const Rigid3d* MultiRobotMap::State::PoseOf(const NodeId& node) const {
  const auto position = position_of.find(node.mission);
  if (position == position_of.end()) return nullptr;
  const std::vector<Rigid3d>& poses = missions[position->second].map_from_body;
  return node.index < static_cast<int64_t>(poses.size()) ? &poses[node.index] : nullptr;
}

// Pending closures whose ends have both arrived come into use.
void MultiRobotMap::State::ActivateClosures() {
  for (SnapshotClosure& entry : closures) {
    if (entry.verdict != ClosureVerdict::kPending) continue;
    if (PoseOf(entry.closure.from) == nullptr || PoseOf(entry.closure.to) == nullptr) continue;
    entry.verdict = ClosureVerdict::kAccepted;
    entry.weight = 1;
  }
}

FrameTie MultiRobotMap::State::TieOf(const LoopClosure& closure) const {
  LoopClosure from_older = closure;
  if (FrameOf(closure.to) < FrameOf(closure.from)) {
    // Cov of the inverse: T^-1 = (T_mean Exp(d))^-1 = T_mean^-1 Exp(-Ad(T_mean) d).
    const Matrix6d adjoint = Adjoint(closure.from_tform_to);
    std::swap(from_older.from, from_older.to);
    from_older.from_tform_to = closure.from_tform_to.Inverse();
    from_older.covariance = adjoint * closure.covariance * adjoint.transpose();
  }
  return {*PoseOf(from_older.from), *PoseOf(from_older.to), from_older.from_tform_to,
          from_older.covariance.inverse()};
}

// Of all pairs of frames that closures in use tie, joins the one with the best agreement. Closures
// demoted earlier have a say too, but do not join frames by themselves.
bool MultiRobotMap::State::JoinBestTiedFrames(Joining joining) {
  struct Ties {
    std::vector<FrameTie> all;
    bool may_join = false;
  };
  std::map<std::pair<int, int>, Ties> ties_of_frames;
  for (const SnapshotClosure& entry : closures) {
    if (entry.verdict == ClosureVerdict::kPending) continue;
    const auto frames = std::minmax({FrameOf(entry.closure.from), FrameOf(entry.closure.to)});
    if (frames.first == frames.second) continue;
    Ties& ties = ties_of_frames[frames];
    ties.all.push_back(TieOf(entry.closure));
    ties.may_join |= joining == Joining::kAll || entry.verdict == ClosureVerdict::kAccepted;
  }
  FrameAlignment best;
  std::pair<int, int> best_frames;
  for (const auto& [frames, ties] : ties_of_frames) {
    if (!ties.may_join) continue;
    const FrameAlignment alignment = AlignFrames(ties.all, options.closure_chi_square_limit);
    if (alignment.agreement > best.agreement) {
      best = alignment;
      best_frames = frames;
    }
  }
  if (best.agreement == 0) return false;
  MoveFrame(best_frames.second, best.older_from_younger, best_frames.first);
  return true;
}

void MultiRobotMap::State::JoinFrames(Joining joining) {
  while (JoinBestTiedFrames(joining)) {
  }
}

void MultiRobotMap::State::MoveFrame(int frame, const Rigid3d& new_from_old, int new_frame) {
  for (SnapshotMission& mission : missions) {
    if (mission.component != frame) continue;
    mission.component = new_frame;
    for (Rigid3d& pose : mission.map_from_body) pose = new_from_old * pose;
  }
}

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
// start ends at the lower cost wins.
void MultiRobotMap::State::ReconsiderAlignments(PoseGraph graph, PoseGraphResult& result) {
  const std::vector<SnapshotMission> current = missions;
  for (int m = 0; m < static_cast<int>(missions.size()); ++m) missions[m].component = m;
  JoinFrames(Joining::kAll);
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

// Components anew from the closures in use, each brought into the odometry frame of its oldest
// mission.
void MultiRobotMap::State::SplitFrames() {
  ConnectedComponents components(static_cast<int>(missions.size()));
  for (const SnapshotClosure& entry : closures) {
    if (entry.verdict != ClosureVerdict::kAccepted) continue;
    components.Unite(position_of.at(entry.closure.from.mission),
                     position_of.at(entry.closure.to.mission));
  }
  for (int m = 0; m < static_cast<int>(missions.size()); ++m) {
    missions[m].component = components.Representative(m);
  }
  for (const int oldest : components.Representatives()) {
    const SnapshotMission& mission = missions[oldest];
    const Rigid3d& wanted = mission.keyframes.front().mission_from_body;
    const Rigid3d new_from_old = wanted * mission.map_from_body.front().Inverse();
    // The held pose has not moved: leave round-off out of the others too.
    if (Log(new_from_old).norm() > 1e-9) MoveFrame(oldest, new_from_old, oldest);
  }
}

std::shared_ptr<const MapSnapshot> MultiRobotMap::State::Freeze(const PoseGraphResult& result) {
  auto snapshot = std::make_shared<MapSnapshot>();
  snapshot->revision = ++revision;
  snapshot->map_epoch = map_epoch;
  snapshot->closures = closures;
  snapshot->initial_cost = result.initial_cost;
  snapshot->final_cost = result.final_cost;
  snapshot->converged = result.converged;
  snapshot->optimisation_s = result.seconds;
  std::map<int, int> number_of_frame;  // oldest mission -> 0, 1, ...
  for (const SnapshotMission& mission : missions) number_of_frame[mission.component];
  int next = 0;
  for (auto& [frame, number] : number_of_frame) number = next++;
  for (const auto& [id, position] : position_of) {
    SnapshotMission& mission = snapshot->missions.emplace_back(missions[position]);
    mission.component = number_of_frame[mission.component];
    mission.anchored = mission.component == 0;
    mission.map_from_mission =
        mission.map_from_body.back() * mission.keyframes.back().mission_from_body.Inverse();
  }
  return snapshot;
}

MultiRobotMap::MultiRobotMap(const MultiRobotMapOptions& options, uint64_t map_epoch)
    : state_(std::make_unique<State>()) {
  state_->options = options;
  state_->map_epoch = map_epoch;
}
MultiRobotMap::~MultiRobotMap() = default;
MultiRobotMap::MultiRobotMap(MultiRobotMap&&) noexcept = default;
MultiRobotMap& MultiRobotMap::operator=(MultiRobotMap&&) noexcept = default;

absl::Status MultiRobotMap::AddSubmap(const MissionId& id, const Submap& submap) {
  const auto known = state_->position_of.find(id);
  const SnapshotMission* mission =
      known == state_->position_of.end() ? nullptr : &state_->missions[known->second];
  const int64_t sequence = mission == nullptr ? 0 : mission->submap_starts.size();
  const int64_t first_index = mission == nullptr ? 0 : mission->keyframes.size();
  if (submap.sequence != sequence) {
    return absl::OutOfRangeError(
        absl::StrCat("sequence: expected ", sequence, ", got ", submap.sequence));
  }
  if (submap.first_index != first_index) {
    return absl::OutOfRangeError(
        absl::StrCat("first_index: expected ", first_index, ", got ", submap.first_index));
  }
  RETURN_IF_ERROR(CheckSubmap(id, submap));
  if (mission != nullptr && !(mission->keyframes.back().stamp < submap.keyframes[0].stamp)) {
    return absl::InvalidArgumentError("keyframes[0].stamp: does not increase");
  }
  const int position =
      mission == nullptr ? static_cast<int>(state_->missions.size()) : known->second;
  if (mission == nullptr) {
    state_->position_of[id] = position;
    SnapshotMission& fresh = state_->missions.emplace_back();
    fresh.id = id;
    fresh.component = position;
  }
  state_->AppendKeyframes(submap, state_->missions[position]);
  for (const LoopClosure& closure : submap.loop_closures) state_->InsertClosure(closure);
  state_->dirty = true;
  return absl::OkStatus();
}

absl::Status MultiRobotMap::AddLoopClosure(const LoopClosure& closure) {
  RETURN_IF_ERROR(CheckLoopClosure(closure));
  state_->InsertClosure(closure);
  return absl::OkStatus();
}

bool MultiRobotMap::dirty() const { return state_->dirty; }

std::shared_ptr<const MapSnapshot> MultiRobotMap::Optimise() {
  State& state = *state_;
  state.dirty = false;
  state.ActivateClosures();
  state.JoinFrames(State::Joining::kInUse);
  std::vector<int> edge_of_closure;
  const PoseGraph graph = state.BuildPoseGraph(&edge_of_closure);
  auto result = state.SolveWarm(graph, edge_of_closure);
  if (!result.ok()) {
    // Cannot happen with what AddSubmap and AddLoopClosure let in; if it does, the old estimate
    // stands.
    return state.Freeze(PoseGraphResult());
  }
  if (state.DemotesBetweenMissions(*result, edge_of_closure)) {
    state.ReconsiderAlignments(graph, *result);
  }
  state.TakeResult(*result, edge_of_closure);
  state.SplitFrames();
  return state.Freeze(*result);
}

}  // namespace overtone
