// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/geometry_conversion.h"

#include <cmath>

#include "Eigen/Cholesky"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {
namespace {

constexpr int kTriangleSize = 21;

absl::StatusOr<Eigen::Quaterniond> UnitQuaternion(const v1::Quaternion& message) {
  const Eigen::Quaterniond quaternion(message.w(), message.x(), message.y(), message.z());
  const double norm = quaternion.norm();
  if (!std::isfinite(norm)) return InvalidField("orientation", "not finite");
  const double excess = std::abs(norm - 1.0);
  if (excess > limits::kQuaternionTolerance) {
    return InvalidField("orientation", absl::StrCat("length ", norm, ", a unit quaternion has 1"));
  }
  // Leaving exact ones alone makes decoding the inverse of encoding, bit by bit.
  return excess < 1e-12 ? quaternion : quaternion.normalized();
}

absl::Status ValidateVariances(const Matrix6d& covariance) {
  for (int i = 0; i < 6; ++i) {
    const double variance = covariance(i, i);
    if (variance >= limits::kMinVariance && variance <= limits::kMaxVariance) continue;
    return InvalidField("upper_triangle", absl::StrCat("the variance of element ", i, " is ",
                                                       variance, ", not in [1e-18, 1e12]"));
  }
  return absl::OkStatus();
}

// Tests the correlation matrix, whose scale does not depend on units: metres^2 beside rad^2.
bool IsPositiveDefinite(const Matrix6d& covariance) {
  const Vector6d scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  const Matrix6d correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Matrix6d shifted = correlation - limits::kMinCorrelationEigenvalue * Matrix6d::Identity();
  return Eigen::LLT<Matrix6d>(shifted).info() == Eigen::Success;
}

}  // namespace

v1::Pose ToProto(const Rigid3d& pose) {
  v1::Pose message;
  v1::Vector3& position = *message.mutable_position();
  position.set_x(pose.translation.x());
  position.set_y(pose.translation.y());
  position.set_z(pose.translation.z());
  v1::Quaternion& orientation = *message.mutable_orientation();
  orientation.set_x(pose.rotation.x());
  orientation.set_y(pose.rotation.y());
  orientation.set_z(pose.rotation.z());
  orientation.set_w(pose.rotation.w());
  return message;
}

v1::PoseCovariance ToProto(const Matrix6d& covariance) {
  v1::PoseCovariance message;
  message.mutable_upper_triangle()->Reserve(kTriangleSize);
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column) {
      message.add_upper_triangle(covariance(row, column));
    }
  }
  return message;
}

absl::Status ValidatePosition(const Eigen::Vector3d& position) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(position[axis]) <= limits::kMaxPositionM) continue;  // false for NaN
    const absl::string_view names[] = {"position.x", "position.y", "position.z"};
    return InvalidField(names[axis], absl::StrCat(position[axis], " m is not within +-1e7 m"));
  }
  return absl::OkStatus();
}

absl::StatusOr<Rigid3d> FromProto(const v1::Pose& message) {
  if (!message.has_position()) return InvalidField("position", "missing");
  if (!message.has_orientation()) return InvalidField("orientation", "missing");
  const v1::Vector3& position = message.position();
  const Eigen::Vector3d translation(position.x(), position.y(), position.z());
  RETURN_IF_ERROR(ValidatePosition(translation));
  ASSIGN_OR_RETURN(const Eigen::Quaterniond rotation, UnitQuaternion(message.orientation()));
  return Rigid3d(rotation, translation);
}

absl::StatusOr<Matrix6d> FromProto(const v1::PoseCovariance& message) {
  if (message.upper_triangle_size() != kTriangleSize) {
    return InvalidField("upper_triangle",
                        absl::StrCat(message.upper_triangle_size(), " numbers, not 21"));
  }
  Matrix6d covariance;
  int next = 0;
  for (int row = 0; row < 6; ++row) {
    for (int column = row; column < 6; ++column, ++next) {
      const double value = message.upper_triangle(next);
      if (!std::isfinite(value)) {
        return InvalidField(absl::StrCat("upper_triangle[", next, "]"), "not finite");
      }
      covariance(row, column) = value;
      covariance(column, row) = value;
    }
  }
  RETURN_IF_ERROR(ValidateVariances(covariance));
  if (!IsPositiveDefinite(covariance)) {
    return InvalidField("upper_triangle", "not positive definite");
  }
  return covariance;
}

}  // namespace overtone
