// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <set>
#include <utility>
#include <vector>

#include "Eigen/Eigenvalues"
#include "overtone/core/estimation/connected_components.h"
#include "overtone/core/mapping/frame_joining.h"
#include "overtone/core/mapping/multi_robot_map_state.h"

namespace overtone {
namespace {

// How far apart two estimates of one point may lie: what drift allows, or what it was seen with.
double Tolerance(const Eigen::Matrix3d& covariance, double drift_m) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(covariance, Eigen::EigenvaluesOnly);
  return std::max(drift_m, 3 * std::sqrt(eigen.eigenvalues().maxCoeff()));
}

std::pair<int, int> InOrder(int a, int b) { return std::minmax(a, b); }

PointTie MakePointTie(int frame_a, const Eigen::Vector3d& point_in_a,
                      const Eigen::Vector3d& point_in_b, int frame_b, double tolerance_m) {
  if (frame_a < frame_b) return {point_in_a, point_in_b, tolerance_m};
  return {point_in_b, point_in_a, tolerance_m};
}

}  // namespace

FrameTie MultiRobotMap::State::TieOf(const LoopCandidate& candidate) const {
  const LoopCandidate from_older =
      FrameOf(candidate.to) < FrameOf(candidate.from) ? Reversed(candidate) : candidate;
  return {*PoseOf(from_older.from), *PoseOf(from_older.to), from_older.from_tform_to,
          from_older.covariance.inverse()};
}

// Closures demoted earlier have a say too, but do not join frames by themselves. Pairs that only
// look alike have none: of a dozen wrong ones three agree by chance.
void MultiRobotMap::State::AddClosureTies(Joining joining, TiesOfFrames& ties_of_frames) const {
  std::map<std::pair<int, int>, std::set<std::pair<NodeId, NodeId>>> ends_of_missions;
  for (int k = 0; k < static_cast<int>(closures.size()); ++k) {
    if (!InPlay(k) || !TiesMissions(closures[k])) continue;
    const ClosureRecord& record = closures[k];
    const LoopCandidate& candidate = record.candidate;
    const int from = FrameOf(candidate.from), to = FrameOf(candidate.to);
    if (from == to) continue;
    Ties& ties = ties_of_frames[InOrder(from, to)];
    if (RotationIsOpen(candidate.covariance)) {
      const Eigen::Matrix3d covariance = candidate.covariance.topLeftCorner<3, 3>();
      ties.points.push_back(
          MakePointTie(from, *PoseOf(candidate.from) * candidate.from_tform_to.translation,
                       PoseOf(candidate.to)->translation, to,
                       Tolerance(covariance, options.point_alignment_tolerance_m)));
    } else {
      ties.poses.push_back(TieOf(candidate));
      ties.closures.push_back(k);
    }
    if (record.verdict == ClosureVerdict::kDemotedByOptimiser && joining == Joining::kInUse) {
      continue;
    }
    ties.may_join = true;
    ties.certain |= record.verdict == ClosureVerdict::kForcedByOperator;
    if (RotationIsOpen(candidate.covariance)) continue;
    auto& ends = ends_of_missions[InOrder(PositionOf(candidate.from), PositionOf(candidate.to))];
    ends.insert({candidate.from, candidate.to});
    ties.support = std::max(ties.support, static_cast<int>(ends.size()));
  }
}

void MultiRobotMap::State::AddLandmarkTies(TiesOfFrames& ties_of_frames) const {
  std::map<std::string, std::vector<std::pair<int, Eigen::Vector3d>>> frames_of_landmark;
  for (const auto& [frame_and_id, position] : landmarks) {
    frames_of_landmark[frame_and_id.second].emplace_back(frame_and_id.first, position);
  }
  for (const auto& [id, frames] : frames_of_landmark) {
    for (size_t a = 0; a < frames.size(); ++a) {
      for (size_t b = a + 1; b < frames.size(); ++b) {
        Ties& ties = ties_of_frames[InOrder(frames[a].first, frames[b].first)];
        ties.points.push_back(MakePointTie(frames[a].first, frames[a].second, frames[b].second,
                                           frames[b].first, options.point_alignment_tolerance_m));
        ties.may_join = true;
      }
    }
  }
}

void MultiRobotMap::State::AddSightingTies(TiesOfFrames& ties_of_frames) const {
  for (const SightingRecord& sighting : sightings) {
    if (sighting.pending || sighting.robot.empty()) continue;
    const int observer = FrameOf(sighting.observer), target = FrameOf(sighting.target);
    if (observer == target) continue;
    Ties& ties = ties_of_frames[InOrder(observer, target)];
    ties.points.push_back(
        MakePointTie(observer, *PoseOf(sighting.observer) * sighting.point_in_body,
                     *PoseOf(sighting.target) * sighting.point_in_target, target,
                     Tolerance(sighting.covariance, options.point_alignment_tolerance_m)));
    ties.may_join = true;
  }
}

void MultiRobotMap::State::AddAbsoluteTies(TiesOfFrames& ties_of_frames) const {
  for (const AbsoluteRecord& absolute : absolutes) {
    const int frame = FrameOf(absolute.node);
    if (frame == kWorld) continue;
    Ties& ties = ties_of_frames[{kWorld, frame}];
    ties.may_join = true;
    const Rigid3d& pose = *PoseOf(absolute.node);
    if (RotationIsOpen(absolute.covariance)) {
      const Eigen::Matrix3d covariance = absolute.covariance.topLeftCorner<3, 3>();
      ties.points.push_back({absolute.map_from_body.translation, pose.translation,
                             Tolerance(covariance, options.point_alignment_tolerance_m)});
    } else {
      ties.poses.push_back(
          {Rigid3d(), pose, absolute.map_from_body, absolute.covariance.inverse()});
      ties.closures.push_back(-1);
      ties.certain = true;
    }
  }
}

MultiRobotMap::State::TiesOfFrames MultiRobotMap::State::CollectTies(Joining joining) const {
  TiesOfFrames ties;
  AddClosureTies(joining, ties);
  AddLandmarkTies(ties);
  AddSightingTies(ties);
  AddAbsoluteTies(ties);
  return ties;
}

// A first tie needs company: enough consistent closures, or points whose arrangement agrees.
bool MultiRobotMap::State::Suffice(const Ties& ties, const FrameAlignment& alignment) const {
  if (alignment.agreement <= 0) return false;
  return ties.certain || alignment.tie < 0 || ties.support >= options.min_consistent_closures;
}

// Of all pairs of frames that are tied well enough, joins the one with the best agreement.
bool MultiRobotMap::State::JoinBestTiedFrames(Joining joining, std::vector<int>& aligning) {
  FrameAlignment best;
  std::pair<int, int> best_frames;
  int best_closure = -1;
  for (const auto& [frames, ties] : CollectTies(joining)) {
    if (!ties.may_join) continue;
    const bool closures_suffice = ties.certain || ties.support >= options.min_consistent_closures;
    const FrameAlignment alignment =
        AlignFrames(closures_suffice ? ties.poses : std::vector<FrameTie>(), ties.points,
                    options.closure_chi_square_limit);
    if (!Suffice(ties, alignment) || alignment.agreement <= best.agreement) continue;
    best = alignment;
    best_frames = frames;
    best_closure = alignment.tie < 0 ? -1 : ties.closures[alignment.tie];
  }
  if (best.agreement <= 0) return false;
  MoveFrame(best_frames.second, best.older_from_younger, best_frames.first);
  aligning.push_back(best_closure);
  return true;
}

std::vector<int> MultiRobotMap::State::JoinFrames(Joining joining) {
  std::vector<int> aligning;
  while (JoinBestTiedFrames(joining, aligning)) {
  }
  return aligning;
}

// What would tie frames that are still apart waits; what waited and no longer does gets its chance.
void MultiRobotMap::State::Quarantine() {
  for (int k = 0; k < static_cast<int>(closures.size()); ++k) {
    if (!InPlay(k)) continue;
    ClosureRecord& record = closures[k];
    if (FrameOf(record.candidate.from) != FrameOf(record.candidate.to)) {
      SetVerdict(record, ClosureVerdict::kQuarantined);
      record.weight = 0;
    } else if (record.verdict == ClosureVerdict::kQuarantined) {
      SetVerdict(record, ClosureVerdict::kAccepted);
      record.weight = 1;
    }
  }
}

void MultiRobotMap::State::MoveFrame(int frame, const Rigid3d& new_from_old, int new_frame) {
  for (SnapshotMission& mission : missions) {
    if (mission.component != frame) continue;
    mission.component = new_frame;
    for (Rigid3d& pose : mission.map_from_body) pose = new_from_old * pose;
  }
  const auto begin = landmarks.lower_bound({frame, ""});
  auto end = begin;
  std::vector<std::pair<std::string, Eigen::Vector3d>> moved;
  for (; end != landmarks.end() && end->first.first == frame; ++end) {
    moved.emplace_back(end->first.second, new_from_old * end->second);
  }
  landmarks.erase(begin, end);
  // A landmark that the new frame knows already stays where that has it.
  for (const auto& [id, position] : moved) landmarks.insert({{new_frame, id}, position});
}

// Components anew from what is in use, each brought into the odometry frame of its oldest mission,
// but for the one that is tied to the world.
void MultiRobotMap::State::SplitFrames() {
  const int world = 0, first_mission = 1;
  std::map<std::pair<int, std::string>, int> element_of_landmark;
  for (const auto& [frame_and_id, position] : landmarks) {
    const int element = first_mission + static_cast<int>(missions.size()) +
                        static_cast<int>(element_of_landmark.size());
    element_of_landmark[frame_and_id] = element;
  }
  ConnectedComponents components(first_mission +
                                 static_cast<int>(missions.size() + element_of_landmark.size()));
  const auto element_of = [&](const NodeId& node) { return first_mission + PositionOf(node); };
  for (const ClosureRecord& record : closures) {
    if (!InUse(record.verdict) || !TiesMissions(record)) continue;
    const LoopCandidate& candidate = record.candidate;
    if (FrameOf(candidate.from) != FrameOf(candidate.to)) continue;  // not aligned yet
    components.Unite(element_of(candidate.from), element_of(candidate.to));
  }
  for (const SightingRecord& sighting : sightings) {
    if (sighting.pending || sighting.weight <= 0) continue;
    const int frame = FrameOf(sighting.observer);
    if (!sighting.landmark.empty()) {
      const auto landmark = element_of_landmark.find({frame, sighting.landmark});
      if (landmark == element_of_landmark.end()) continue;
      components.Unite(element_of(sighting.observer), landmark->second);
    } else if (FrameOf(sighting.target) == frame) {
      components.Unite(element_of(sighting.observer), element_of(sighting.target));
    }
  }
  for (const AbsoluteRecord& absolute : absolutes) {
    if (absolute.weight > 0 && FrameOf(absolute.node) == kWorld) {
      components.Unite(world, element_of(absolute.node));
    }
  }
  const auto frame_of = [&](int element) {
    const int representative = components.Representative(element);
    return representative == world ? kWorld : representative - first_mission;
  };
  std::map<std::pair<int, std::string>, Eigen::Vector3d> kept_landmarks;
  for (const auto& [frame_and_id, element] : element_of_landmark) {
    // One that nothing in use sees any more is forgotten: it comes back with its next sighting.
    if (components.Representative(element) == element) continue;
    kept_landmarks[{frame_of(element), frame_and_id.second}] = landmarks.at(frame_and_id);
  }
  landmarks = std::move(kept_landmarks);
  for (int m = 0; m < static_cast<int>(missions.size()); ++m) {
    missions[m].component = frame_of(first_mission + m);
  }
  for (int m = 0; m < static_cast<int>(missions.size()); ++m) {
    if (missions[m].component != m) continue;
    const SnapshotMission& oldest = missions[m];
    const Rigid3d& wanted = oldest.keyframes.front().mission_from_body;
    const Rigid3d new_from_old = wanted * oldest.map_from_body.front().Inverse();
    // The held pose has not moved: leave round-off out of the others too.
    if (Log(new_from_old).norm() > 1e-9) MoveFrame(m, new_from_old, m);
  }
}

}  // namespace overtone
