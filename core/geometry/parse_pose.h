// SPDX-License-Identifier: Apache-2.0
// Poses out of numbers that somebody else wrote: checked, and brought to unit length.
#ifndef OVERTONE_CORE_GEOMETRY_PARSE_POSE_H_
#define OVERTONE_CORE_GEOMETRY_PARSE_POSE_H_

#include "absl/status/statusor.h"
#include "absl/strings/string_view.h"
#include "absl/types/span.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

// Off by less than this, a quaternion's length or a rotation matrix's orthonormality is rounding
// and is repaired.
inline constexpr double kRotationTolerance = 1e-3;
// As on the wire: beyond, a position is a defect.
inline constexpr double kMaxPosition_m = 1e7;

// The pose of a position and a quaternion x y z w, normalised.
// InvalidArgument: not finite, a coordinate beyond kMaxPosition_m, length not 1 within
// kRotationTolerance.
absl::StatusOr<Rigid3d> CheckedPose(const Eigen::Vector3d& position, const Eigen::Vector4d& xyzw);

// The pose of a row-major 3 x 4 matrix [R t], R replaced by the nearest rotation.
// InvalidArgument: as above, or an entry of R^T R - I above kRotationTolerance, or det R < 0.
absl::StatusOr<Rigid3d> CheckedPose(const Eigen::Matrix<double, 3, 4>& matrix);

// Seven fields: x y z qx qy qz qw.
absl::StatusOr<Rigid3d> ParsePose(absl::Span<const absl::string_view> fields);

}  // namespace overtone

#endif  // OVERTONE_CORE_GEOMETRY_PARSE_POSE_H_
