// SPDX-License-Identifier: Apache-2.0
// A mission as the optimiser sees it: its first keyframe and those that something beside odometry
// ties (joints), with one edge for each stretch of odometry between two of them
// (chain_relaxation.h). What follows the last joint follows it by odometry.
#ifndef OVERTONE_CORE_MAPPING_MISSION_CHAIN_H_
#define OVERTONE_CORE_MAPPING_MISSION_CHAIN_H_

#include <vector>

#include "overtone/core/estimation/chain_relaxation.h"

namespace overtone {

class MissionChain {
 public:
  struct Stretch {
    int first = 0, last = 0;  // keyframes, joints both
    Rigid3d first_from_last;  // where it was relaxed
    CompoundMotion edge;
  };

  // `joints`: increasing, from 0. Stretches that were there before stay as they are; new ones are
  // relaxed between their ends, and the poses after the last joint follow it.
  void SetJoints(std::vector<int> joints, const ChainMotions& motions, std::vector<Rigid3d>& poses);

  // The motions into keyframe `from` and later ones, or the poses between joints there, are not
  // what they were: the next SetJoints looks at them anew.
  void Forget(int from);

  // Gives the joints new poses, and every other keyframe the best one between or after them. A
  // stretch whose ends moved against each other is relaxed. What the motions then cost more than
  // the edges said they would, absolute, twice.
  double Move(const Rigid3d* pose_of_joint, const ChainMotions& motions,
              std::vector<Rigid3d>& poses);

  const std::vector<int>& joints() const { return joints_; }
  // Between joint j and j + 1 is stretch j.
  const std::vector<Stretch>& stretches() const { return stretches_; }
  // Which joint a keyframe is; it must be one.
  int JointOf(int keyframe) const;

 private:
  void FollowLast(const ChainMotions& motions, std::vector<Rigid3d>& poses) const;

  std::vector<int> joints_ = {0};
  std::vector<Stretch> stretches_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_MISSION_CHAIN_H_
