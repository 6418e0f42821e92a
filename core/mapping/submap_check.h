// SPDX-License-Identifier: Apache-2.0
// What a submap and a loop closure must satisfy in themselves before the map takes them.
#ifndef OVERTONE_CORE_MAPPING_SUBMAP_CHECK_H_
#define OVERTONE_CORE_MAPPING_SUBMAP_CHECK_H_

#include "absl/status/status.h"
#include "overtone/core/graph/submap.h"

namespace overtone {

// InvalidArgument naming the field ("keyframes[3].stamp"): no keyframes; stamps not strictly
// increasing; a pose not finite, not of unit rotation or further than 1e8 m out; a covariance not
// positive definite (the first of a mission is not read); a closure that fails CheckLoopClosure; a
// closure or candidate without an end in `mission`; a score outside [0, 1]; a degenerate direction
// that is not of unit length or without `degenerate`; a cloud, sighting or absolute pose of a
// keyframe that is not in the submap; two clouds of one keyframe; a landmark or robot that is no
// id; a robot that sees itself.
absl::Status CheckSubmap(const MissionId& mission, const Submap& submap);

// InvalidArgument naming the field: both ends the same keyframe, an index below 0, an invalid
// transform or covariance.
absl::Status CheckLoopClosure(const LoopClosure& closure);

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_SUBMAP_CHECK_H_
