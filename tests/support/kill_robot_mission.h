// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_TESTS_SUPPORT_KILL_ROBOT_MISSION_H_
#define OVERTONE_TESTS_SUPPORT_KILL_ROBOT_MISSION_H_

#include "overtone/tests/support/straight_mission.h"

namespace overtone {

// The same content whenever it is made: 10 keyframes, two clouds that no other submap has.
inline Submap KillRobotSubmap(int64_t sequence) {
  return WithClouds(StraightSubmap(sequence), /*num_clouds=*/2, /*points_per_cloud=*/500);
}

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_KILL_ROBOT_MISSION_H_
