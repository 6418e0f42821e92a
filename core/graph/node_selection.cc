// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/graph/node_selection.h"

namespace overtone {

absl::Status KeyframeSelectionOptions::Validate() const {
  if (!(min_distance_m >= 0)) {
    return absl::InvalidArgumentError("min_distance_m: must be >= 0");
  }
  if (!(min_rotation_rad >= 0)) {
    return absl::InvalidArgumentError("min_rotation_rad: must be >= 0");
  }
  return absl::OkStatus();
}

std::vector<int> SelectKeyframes(const std::vector<Rigid3d>& poses,
                                 const KeyframeSelectionOptions& options) {
  std::vector<int> kept;
  const int last = static_cast<int>(poses.size()) - 1;
  for (int i = 0; i <= last; ++i) {
    if (i > 0 && i < last) {
      const Rigid3d motion = poses[kept.back()].Inverse() * poses[i];
      const bool moved = motion.translation.norm() >= options.min_distance_m ||
                         LogSO3(motion.rotation).norm() >= options.min_rotation_rad;
      if (!moved) continue;
    }
    kept.push_back(i);
  }
  return kept;
}

}  // namespace overtone
