// SPDX-License-Identifier: Apache-2.0
// What a submap and a loop closure must satisfy in themselves before the map takes them.
#ifndef OVERTONE_CORE_MAPPING_SUBMAP_CHECK_H_
#define OVERTONE_CORE_MAPPING_SUBMAP_CHECK_H_

#include "absl/status/status.h"
#include "overtone/core/graph/submap.h"

namespace overtone {

// InvalidArgument naming the field ("keyframes[3].stamp"): no keyframes; stamps not strictly
// increasing; a pose not finite, not of unit rotation or further than 1e8 m out; a covariance not
// positive definite (the first of a mission is not read); a closure that fails CheckLoopClosure or
// has no end in `mission`.
absl::Status CheckSubmap(const MissionId& mission, const Submap& submap);

// InvalidArgument naming the field: both ends the same keyframe, an index below 0, an invalid
// transform or covariance.
absl::Status CheckLoopClosure(const LoopClosure& closure);

}  // namespace overtone

#endif  // OVERTONE_CORE_MAPPING_SUBMAP_CHECK_H_
