// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>
#include <vector>

#include "overtone/core/estimation/connected_components.h"
#include "overtone/core/mapping/frame_joining.h"
#include "overtone/core/mapping/multi_robot_map_state.h"

namespace overtone {

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
int MultiRobotMap::State::JoinBestTiedFrames(Joining joining) {
  struct Ties {
    std::vector<FrameTie> all;
    std::vector<int> closures;
    bool may_join = false;
  };
  std::map<std::pair<int, int>, Ties> ties_of_frames;
  for (size_t k = 0; k < closures.size(); ++k) {
    const SnapshotClosure& entry = closures[k];
    if (entry.verdict == ClosureVerdict::kPending) continue;
    const auto frames = std::minmax({FrameOf(entry.closure.from), FrameOf(entry.closure.to)});
    if (frames.first == frames.second) continue;
    Ties& ties = ties_of_frames[frames];
    ties.all.push_back(TieOf(entry.closure));
    ties.closures.push_back(static_cast<int>(k));
    ties.may_join |= joining == Joining::kAll || entry.verdict == ClosureVerdict::kAccepted;
  }
  FrameAlignment best;
  std::pair<int, int> best_frames;
  int best_closure = -1;
  for (const auto& [frames, ties] : ties_of_frames) {
    if (!ties.may_join) continue;
    const FrameAlignment alignment = AlignFrames(ties.all, options.closure_chi_square_limit);
    if (alignment.agreement > best.agreement) {
      best = alignment;
      best_frames = frames;
      best_closure = ties.closures[alignment.tie];
    }
  }
  if (best_closure >= 0) {
    MoveFrame(best_frames.second, best.older_from_younger, best_frames.first);
  }
  return best_closure;
}

std::vector<int> MultiRobotMap::State::JoinFrames(Joining joining) {
  std::vector<int> aligning;
  for (int k = JoinBestTiedFrames(joining); k >= 0; k = JoinBestTiedFrames(joining)) {
    aligning.push_back(k);
  }
  return aligning;
}

void MultiRobotMap::State::MoveFrame(int frame, const Rigid3d& new_from_old, int new_frame) {
  for (SnapshotMission& mission : missions) {
    if (mission.component != frame) continue;
    mission.component = new_frame;
    for (Rigid3d& pose : mission.map_from_body) pose = new_from_old * pose;
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

}  // namespace overtone
