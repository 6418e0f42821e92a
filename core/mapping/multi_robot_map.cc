// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/multi_robot_map.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/mapping/multi_robot_map_state.h"
#include "overtone/core/mapping/submap_check.h"

namespace overtone {
namespace {

bool SameMeasurement(const LoopCandidate& a, const LoopCandidate& b) {
  return a.proposer == b.proposer &&
         a.from_tform_to.rotation.coeffs() == b.from_tform_to.rotation.coeffs() &&
         a.from_tform_to.translation == b.from_tform_to.translation && a.covariance == b.covariance;
}

absl::Status CheckPositive(absl::string_view name, double value) {
  if (value > 0 && std::isfinite(value)) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat(name, " must be positive and finite"));
}

}  // namespace

absl::Status MultiRobotMapOptions::Validate() const {
  RETURN_IF_ERROR(CheckPositive("closure_chi_square_limit", closure_chi_square_limit));
  RETURN_IF_ERROR(CheckPositive("sighting_chi_square_limit", sighting_chi_square_limit));
  RETURN_IF_ERROR(CheckPositive("consistency_chi_square_limit", consistency_chi_square_limit));
  RETURN_IF_ERROR(CheckPositive("point_alignment_tolerance_m", point_alignment_tolerance_m));
  RETURN_IF_ERROR(CheckPositive("degenerate_motion_share", degenerate_motion_share));
  RETURN_IF_ERROR(CheckPositive("scored_position_sigma_m", scored_position_sigma_m));
  if (!(min_candidate_score >= 0 && min_candidate_score <= 1)) {
    return absl::InvalidArgumentError("min_candidate_score must be in [0, 1]");
  }
  if (min_consistent_closures < 1) {
    return absl::InvalidArgumentError("min_consistent_closures must be at least 1");
  }
  if (max_iterations < 1) return absl::InvalidArgumentError("max_iterations must be at least 1");
  if (num_threads < 1) return absl::InvalidArgumentError("num_threads must be at least 1");
  return absl::OkStatus();
}

// New keyframes follow from the mission's last optimised pose by odometry.
void MultiRobotMap::State::AppendKeyframes(const Submap& submap, int position) {
  SnapshotMission& mission = missions[position];
  UncertainTrajectory& path = odometry[position];
  mission.submap_starts.push_back(submap.first_index);
  const Keyframe* previous = mission.keyframes.empty() ? nullptr : &mission.keyframes.back();
  for (const Keyframe& keyframe : submap.keyframes) {
    Rigid3d motion;
    Rigid3d map_from_body = keyframe.mission_from_body, path_from_body = map_from_body;
    if (previous != nullptr) {
      motion = previous->mission_from_body.Inverse() * keyframe.mission_from_body;
      map_from_body = mission.map_from_body.back() * motion;
      path_from_body = path.WorldFromBody(path.Size() - 1) * motion;
    }
    const Matrix6d covariance = MotionCovariance(previous, keyframe);
    mission.map_from_body.push_back(map_from_body);
    path.Append(path_from_body, covariance);
    motions[position].push_back({motion, PackedCovariance(covariance)});
    previous = &keyframe;
  }
  mission.keyframes.Append(submap.keyframes);
}

void MultiRobotMap::State::AppendMeasurements(const MissionId& mission, const Submap& submap) {
  for (const LoopClosure& closure : submap.loop_closures) InsertCandidate(CandidateOf(closure));
  for (const LandmarkSighting& sighting : submap.landmark_sightings) {
    SightingRecord& record = sightings.emplace_back();
    record.observer = {mission, sighting.index};
    record.landmark = sighting.landmark;
    record.point_in_body = sighting.point_in_body;
    record.covariance = sighting.covariance;
  }
  for (const RobotSighting& sighting : submap.robot_sightings) {
    SightingRecord& record = sightings.emplace_back();
    record.observer = {mission, sighting.index};
    record.robot = sighting.robot;
    record.point_in_body = sighting.point_in_body;
    record.covariance = sighting.covariance;
  }
  for (const AbsolutePose& absolute : submap.absolute_poses) {
    absolutes.push_back({{mission, absolute.index}, absolute.map_from_body, absolute.covariance});
  }
}

void MultiRobotMap::State::InsertCandidate(const LoopCandidate& candidate) {
  const std::string ends = absl::StrCat(ToString(candidate.from), ">", ToString(candidate.to), "#");
  std::string id;
  for (int number = 0;; ++number) {
    id = absl::StrCat(ends, number);
    const auto same_ends = closure_of_id.find(id);
    if (same_ends == closure_of_id.end()) break;
    if (SameMeasurement(closures[same_ends->second].candidate, candidate)) return;
  }
  const int position = static_cast<int>(closures.size());
  ClosureRecord& record = closures.emplace_back();
  record.id = std::move(id);
  record.candidate = candidate;
  record.verdict = JudgeFigures(candidate);
  record.since_revision = revision + 1;
  closure_of_id[record.id] = position;
  decisions.push_back(ClosureDecision::kNone);
  consistency_row.push_back(-1);
  dirty = true;
}

const Rigid3d* MultiRobotMap::State::PoseOf(const NodeId& node) const {
  const auto position = position_of.find(node.mission);
  if (position == position_of.end()) return nullptr;
  const std::vector<Rigid3d>& poses = missions[position->second].map_from_body;
  return node.index < static_cast<int64_t>(poses.size()) ? &poses[node.index] : nullptr;
}

bool MultiRobotMap::State::InPlay(int closure) const {
  switch (closures[closure].verdict) {
    case ClosureVerdict::kAccepted:
    case ClosureVerdict::kForcedByOperator:
    case ClosureVerdict::kDemotedByOptimiser:
    case ClosureVerdict::kQuarantined:
      return true;
    default:
      return false;
  }
}

std::shared_ptr<const MapSnapshot> MultiRobotMap::State::Freeze() const {
  auto snapshot = std::make_shared<MapSnapshot>();
  snapshot->revision = revision;
  snapshot->map_epoch = map_epoch;
  snapshot->closures = closures;
  snapshot->initial_cost = last_result.initial_cost;
  snapshot->final_cost = last_result.final_cost;
  snapshot->converged = last_result.converged;
  snapshot->optimisation_s = last_result.seconds;
  std::map<int, int> number_of_frame;  // world, then oldest mission -> 0, 1, ...
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
  std::map<std::pair<int, std::string>, int> sightings_of;
  for (const SightingRecord& sighting : sightings) {
    if (sighting.pending) continue;
    ++(sighting.weight > 0 ? snapshot->sightings : snapshot->sightings_demoted);
    if (sighting.weight > 0 && !sighting.landmark.empty()) {
      ++sightings_of[{FrameOf(sighting.observer), sighting.landmark}];
    }
  }
  for (const AbsoluteRecord& absolute : absolutes) {
    ++(absolute.weight > 0 ? snapshot->sightings : snapshot->sightings_demoted);
  }
  for (const auto& [frame_and_id, position] : landmarks) {
    snapshot->landmarks.push_back({frame_and_id.second, number_of_frame[frame_and_id.first],
                                   position, sightings_of[frame_and_id]});
  }
  return snapshot;
}

std::shared_ptr<const MapSnapshot> MultiRobotMap::State::Publish(const PoseGraphResult& result) {
  last_result.initial_cost = result.initial_cost;
  last_result.final_cost = result.final_cost;
  last_result.converged = result.converged;
  last_result.seconds = result.seconds;
  std::shared_ptr<const MapSnapshot> snapshot = Freeze();
  history.Add(snapshot);
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
    state_->odometry.emplace_back();
    state_->motions.emplace_back();
    state_->chains.emplace_back();
  }
  state_->AppendKeyframes(submap, position);
  state_->AppendMeasurements(id, submap);
  state_->dirty = true;
  return absl::OkStatus();
}

absl::Status MultiRobotMap::AddLoopClosure(const LoopClosure& closure) {
  return AddCandidate(CandidateOf(closure));
}

absl::Status MultiRobotMap::AddCandidate(const LoopCandidate& candidate) {
  RETURN_IF_ERROR(CheckLoopClosure(
      {candidate.from, candidate.to, candidate.from_tform_to, candidate.covariance}));
  state_->InsertCandidate(candidate);
  return absl::OkStatus();
}

absl::Status MultiRobotMap::AddScoredCandidate(const ScoredCandidate& candidate) {
  return AddCandidate(WeakCandidateOf(candidate, state_->options.min_candidate_score,
                                      state_->options.scored_position_sigma_m));
}

bool MultiRobotMap::dirty() const { return state_->dirty; }

uint64_t MultiRobotMap::revision() const { return state_->revision; }

const RevisionHistory& MultiRobotMap::history() const { return state_->history; }

std::shared_ptr<const MapSnapshot> MultiRobotMap::Optimise(const std::atomic<bool>* give_up) {
  State& state = *state_;
  State::Estimate before = state.Save();
  state.give_up = give_up;
  state.dirty = false;
  ++state.revision;
  state.FollowRefinedMotions();
  state.ActivateClosures();
  state.ActivateSightings();
  state.JudgeConsistency();
  state.JoinFrames(State::Joining::kInUse);
  state.JudgeWeakClosures();
  state.Quarantine();
  MapProblem problem = state.BuildProblem();
  const auto result = state.SolveAndReconsider(problem);
  if (absl::IsCancelled(result.status())) {
    state.GoBack(std::move(before));
    --state.revision;
    state.dirty = true;
    return nullptr;
  }
  // Cannot happen with what AddSubmap and AddCandidate let in; if it does, the old estimate stands.
  if (!result.ok()) return state.Publish(PoseGraphResult());
  state.TakeResult(*result, problem);
  state.SplitFrames();
  return state.Publish(*result);
}

}  // namespace overtone
