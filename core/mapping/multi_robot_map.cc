// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/multi_robot_map.h"

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/estimation/pose_graph_optimizer.h"
#include "overtone/core/mapping/multi_robot_map_state.h"
#include "overtone/core/mapping/submap_check.h"

namespace overtone {
namespace {

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
    state.ReconsiderAlignments(graph, edge_of_closure, *result);
  }
  state.TakeResult(*result, edge_of_closure);
  state.SplitFrames();
  return state.Freeze(*result);
}

}  // namespace overtone
