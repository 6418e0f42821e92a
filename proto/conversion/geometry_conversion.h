// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_PROTO_CONVERSION_GEOMETRY_CONVERSION_H_
#define OVERTONE_PROTO_CONVERSION_GEOMETRY_CONVERSION_H_

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/geometry/se3.h"
#include "overtone/v1/geometry.pb.h"
#include "overtone/v1/submap.pb.h"

namespace overtone {

v1::Pose ToProto(const Rigid3d& pose);
v1::Vector3 ToProto(const Eigen::Vector3d& vector);
// The upper triangle, row by row.
v1::PoseCovariance ToProto(const Matrix6d& covariance);
v1::PointCovariance ToProto(const Eigen::Matrix3d& covariance);

// InvalidArgument: position or orientation missing; not finite; a position beyond 1e7 m; a
// quaternion more than 1e-3 from unit length. Within that it is normalised, and one within 1e-12 is
// taken bit by bit.
absl::StatusOr<Rigid3d> FromProto(const v1::Pose& message);

// InvalidArgument: not finite, or a coordinate beyond 1e7 m.
absl::StatusOr<Eigen::Vector3d> FromProto(const v1::Vector3& message);

// InvalidArgument: not 21 or 6 numbers, not finite, a variance outside [1e-18, 1e12], or not
// positive definite.
absl::StatusOr<Matrix6d> FromProto(const v1::PoseCovariance& message);
absl::StatusOr<Eigen::Matrix3d> FromProto(const v1::PointCovariance& message);

// The checks of FromProto on a position; `position` is its field's name in the error.
absl::Status ValidatePosition(const Eigen::Vector3d& position);

}  // namespace overtone

#endif  // OVERTONE_PROTO_CONVERSION_GEOMETRY_CONVERSION_H_
