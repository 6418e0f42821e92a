// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "overtone/core/mapping/multi_robot_map_state.h"

namespace overtone {

// Every closure's standing before the checks between closures: an operator's word first, then its
// ends, then its figures. What earlier revisions found out about those in play stays.
void MultiRobotMap::State::ActivateClosures() {
  for (size_t k = 0; k < closures.size(); ++k) {
    ClosureRecord& record = closures[k];
    const bool decided = record.verdict == ClosureVerdict::kVetoedByOperator ||
                         record.verdict == ClosureVerdict::kForcedByOperator;
    ClosureVerdict verdict = decided ? ClosureVerdict::kPending : record.verdict;
    const bool ends_known =
        PoseOf(record.candidate.from) != nullptr && PoseOf(record.candidate.to) != nullptr;
    if (IsVetoed(k)) {
      verdict = ClosureVerdict::kVetoedByOperator;
    } else if (!ends_known) {
      verdict = ClosureVerdict::kPending;
    } else if (decisions[k] == ClosureDecision::kForced) {
      verdict = ClosureVerdict::kForcedByOperator;
    } else if (verdict == ClosureVerdict::kPending) {
      verdict = JudgeFigures(record.candidate);
      if (verdict == ClosureVerdict::kPending && record.candidate.measured) {
        verdict = ClosureVerdict::kAccepted;
      }
    }
    if (verdict == record.verdict) continue;
    SetVerdict(record, verdict);
    record.weight = InUse(verdict) ? 1 : 0;
  }
}

void MultiRobotMap::State::ActivateSightings() {
  for (SightingRecord& sighting : sightings) {
    if (!sighting.pending) continue;
    if (sighting.landmark.empty()) {
      Locate(sighting);
    } else {
      sighting.pending = false;
    }
  }
}

// The keyframe of the robot that was seen, last before the stamp of the sighting, and how far its
// odometry had gone from there by then.
void MultiRobotMap::State::Locate(SightingRecord& sighting) const {
  const Timestamp stamp =
      missions[PositionOf(sighting.observer)].keyframes[sighting.observer.index].stamp;
  for (const SnapshotMission& mission : missions) {
    if (mission.id.robot != sighting.robot) continue;
    const KeyframeBlocks& keyframes = mission.keyframes;
    if (stamp < keyframes.front().stamp || keyframes.back().stamp < stamp) continue;
    const auto after = std::upper_bound(
        keyframes.begin(), keyframes.end(), stamp,
        [](Timestamp time, const Keyframe& keyframe) { return time < keyframe.stamp; });
    const auto before = after - 1;
    sighting.target = {mission.id, before - keyframes.begin()};
    sighting.point_in_target = Eigen::Vector3d::Zero();
    if (after != keyframes.end()) {
      const double share =
          SecondsBetween(before->stamp, stamp) / SecondsBetween(before->stamp, after->stamp);
      const Rigid3d motion = before->mission_from_body.Inverse() * after->mission_from_body;
      sighting.point_in_target = Exp(share * Log(motion)).translation;
    }
    sighting.pending = false;
    return;
  }
}

}  // namespace overtone
