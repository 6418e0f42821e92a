// SPDX-License-Identifier: Apache-2.0
// The rigid motion that lays one set of points on another, least squares. Umeyama, IEEE TPAMI
// 13(4), 1991.
#ifndef OVERTONE_CORE_GEOMETRY_RIGID_ALIGNMENT_H_
#define OVERTONE_CORE_GEOMETRY_RIGID_ALIGNMENT_H_

#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

enum class AlignmentMode {
  kSe3,      // any rotation and translation
  kYawOnly,  // rotation about z only: for estimates that know where gravity points
};

// target_from_source minimising sum |target_i - T * source_i|^2 (no scale).
//
// InvalidArgument: lengths differ, a point is not finite, or the points leave the rotation open:
// fewer than three or all on one line (kSe3), no horizontal extent (kYawOnly).
absl::StatusOr<Rigid3d> UmeyamaAlignment(const std::vector<Eigen::Vector3d>& source,
                                         const std::vector<Eigen::Vector3d>& target,
                                         AlignmentMode mode);

}  // namespace overtone

#endif  // OVERTONE_CORE_GEOMETRY_RIGID_ALIGNMENT_H_
