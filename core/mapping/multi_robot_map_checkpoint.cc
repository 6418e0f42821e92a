// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/mapping/multi_robot_map_state.h"

namespace overtone {
namespace {

absl::Status DoesNotFit(const std::string& what) {
  return absl::FailedPreconditionError(absl::StrCat("the checkpoint is of another map: ", what));
}

}  // namespace

MapDecisions MultiRobotMap::Decisions() const {
  MapDecisions decisions;
  decisions.map_epoch = state_->map_epoch;
  for (size_t k = 0; k < state_->closures.size(); ++k) {
    if (state_->decisions[k] == ClosureDecision::kNone) continue;
    decisions.decisions.push_back({state_->closures[k].id, state_->decisions[k]});
  }
  return decisions;
}

void MultiRobotMap::SetDecisions(const MapDecisions& decisions) {
  State& state = *state_;
  std::vector<ClosureDecision> stand(state.closures.size(), ClosureDecision::kNone);
  for (const MapDecisions::Decision& decision : decisions.decisions) {
    const auto found = state.closure_of_id.find(decision.id);
    if (found != state.closure_of_id.end()) stand[found->second] = decision.decision;
  }
  const bool new_epoch = state.map_epoch != decisions.map_epoch && !state.missions.empty();
  state.dirty |= new_epoch || stand != state.decisions;
  state.decisions = std::move(stand);
  state.map_epoch = decisions.map_epoch;
}

MapCheckpoint MultiRobotMap::Checkpoint() const {
  const State& state = *state_;
  MapCheckpoint checkpoint;
  checkpoint.revision = state.revision;
  for (const SnapshotMission& mission : state.missions) {
    checkpoint.missions.push_back({mission.id, mission.component, mission.map_from_body});
  }
  for (const ClosureRecord& record : state.closures) {
    checkpoint.closures.push_back({record.id, record.verdict, record.weight, record.chi_square,
                                   record.since_revision, record.consistent_set});
  }
  for (const SightingRecord& sighting : state.sightings) {
    checkpoint.sighting_weights.push_back(sighting.weight);
  }
  for (const AbsoluteRecord& absolute : state.absolutes) {
    checkpoint.absolute_weights.push_back(absolute.weight);
  }
  for (const auto& [frame_and_id, position] : state.landmarks) {
    checkpoint.landmarks.push_back({frame_and_id.first, frame_and_id.second, position});
  }
  checkpoint.decisions = Decisions();
  const std::deque<RevisionRecord>& records = state.history.records();
  checkpoint.revisions.assign(records.begin(), records.end());
  checkpoint.initial_cost = state.last_result.initial_cost;
  checkpoint.final_cost = state.last_result.final_cost;
  checkpoint.converged = state.last_result.converged;
  checkpoint.optimisation_s = state.last_result.seconds;
  return checkpoint;
}

absl::Status MultiRobotMap::State::CheckFits(const MapCheckpoint& checkpoint) const {
  if (checkpoint.missions.size() != missions.size()) return DoesNotFit("missions");
  const auto is_frame = [&](int frame) {
    return frame == kWorld || (frame >= 0 && frame < static_cast<int>(missions.size()));
  };
  for (size_t m = 0; m < missions.size(); ++m) {
    const MapCheckpoint::Mission& mission = checkpoint.missions[m];
    if (mission.id != missions[m].id || !is_frame(mission.frame) ||
        mission.frame_from_body.size() != missions[m].map_from_body.size()) {
      return DoesNotFit(ToString(missions[m].id));
    }
  }
  if (checkpoint.closures.size() != closures.size()) return DoesNotFit("closures");
  for (size_t k = 0; k < closures.size(); ++k) {
    if (checkpoint.closures[k].id != closures[k].id) return DoesNotFit(closures[k].id);
  }
  if (checkpoint.sighting_weights.size() != sightings.size()) return DoesNotFit("sightings");
  if (checkpoint.absolute_weights.size() != absolutes.size()) return DoesNotFit("absolute poses");
  const bool landmarks_fit =
      std::all_of(checkpoint.landmarks.begin(), checkpoint.landmarks.end(),
                  [&](const MapCheckpoint::Landmark& mark) { return is_frame(mark.frame); });
  return landmarks_fit ? absl::OkStatus() : DoesNotFit("landmarks");
}

absl::StatusOr<std::shared_ptr<const MapSnapshot>> MultiRobotMap::Restore(
    const MapCheckpoint& checkpoint) {
  State& state = *state_;
  RETURN_IF_ERROR(state.CheckFits(checkpoint));
  // What Optimise derives from what came in; its results then replace the poses and verdicts.
  state.FollowRefinedMotions();
  state.ActivateSightings();
  for (size_t m = 0; m < state.missions.size(); ++m) {
    state.missions[m].component = checkpoint.missions[m].frame;
    state.missions[m].map_from_body = checkpoint.missions[m].frame_from_body;
    state.chains[m].Forget(0);
  }
  for (size_t k = 0; k < state.closures.size(); ++k) {
    const MapCheckpoint::Closure& closure = checkpoint.closures[k];
    ClosureRecord& record = state.closures[k];
    record.verdict = closure.verdict;
    record.weight = closure.weight;
    record.chi_square = closure.chi_square;
    record.since_revision = closure.since_revision;
    record.consistent_set = closure.consistent_set;
  }
  for (size_t k = 0; k < state.sightings.size(); ++k) {
    state.sightings[k].weight = checkpoint.sighting_weights[k];
  }
  for (size_t k = 0; k < state.absolutes.size(); ++k) {
    state.absolutes[k].weight = checkpoint.absolute_weights[k];
  }
  state.landmarks.clear();
  for (const MapCheckpoint::Landmark& landmark : checkpoint.landmarks) {
    state.landmarks[{landmark.frame, landmark.id}] = landmark.position;
  }
  SetDecisions(checkpoint.decisions);
  state.revision = checkpoint.revision;
  state.last_result = PoseGraphResult();
  state.last_result.initial_cost = checkpoint.initial_cost;
  state.last_result.final_cost = checkpoint.final_cost;
  state.last_result.converged = checkpoint.converged;
  state.last_result.seconds = checkpoint.optimisation_s;
  state.dirty = false;
  std::shared_ptr<const MapSnapshot> snapshot = state.Freeze();
  state.history.Restore(checkpoint.revisions, snapshot);
  return snapshot;
}

void MultiRobotMap::StartAfter(uint64_t revision) {
  if (revision <= state_->revision) return;
  state_->revision = revision;
  state_->dirty = true;
}

}  // namespace overtone
