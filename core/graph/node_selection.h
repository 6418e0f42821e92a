// SPDX-License-Identifier: Apache-2.0
// Keyframing: the few poses that stand for a run.
#ifndef OVERTONE_CORE_GRAPH_NODE_SELECTION_H_
#define OVERTONE_CORE_GRAPH_NODE_SELECTION_H_

#include <vector>

#include "absl/status/status.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

struct KeyframeSelectionOptions {
  double min_distance_m = 0.4;    // from the last keyframe, straight; 0 keeps every pose
  double min_rotation_rad = 0.3;  // from the last keyframe, geodesic; 0 keeps every pose

  absl::Status Validate() const;  // both >= 0 and not NaN; infinity switches a criterion off
};

// Increasing positions of the poses to keep: each that is min_distance_m or min_rotation_rad away
// from the one kept before it; the first and the last always. Empty for no poses.
std::vector<int> SelectKeyframes(const std::vector<Rigid3d>& poses,
                                 const KeyframeSelectionOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_GRAPH_NODE_SELECTION_H_
