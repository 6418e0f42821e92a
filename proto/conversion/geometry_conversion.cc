// SPDX-License-Identifier: Apache-2.0
#include "overtone/proto/conversion/geometry_conversion.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/geometry/positive_definite.h"
#include "overtone/proto/conversion/field_path.h"
#include "overtone/proto/conversion/limits.h"

namespace overtone {
namespace {

using Triangle = google::protobuf::RepeatedField<double>;

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

absl::Status ValidateCoordinates(const Eigen::Vector3d& vector) {
  for (int axis = 0; axis < 3; ++axis) {
    if (std::abs(vector[axis]) <= limits::kMaxPositionM) continue;  // false for NaN
    const absl::string_view names[] = {"x", "y", "z"};
    return InvalidField(names[axis], absl::StrCat(vector[axis], " m is not within +-1e7 m"));
  }
  return absl::OkStatus();
}

template <typename Matrix>
absl::Status ValidateVariances(const Matrix& covariance) {
  for (int i = 0; i < covariance.rows(); ++i) {
    const double variance = covariance(i, i);
    if (variance >= limits::kMinVariance && variance <= limits::kMaxVariance) continue;
    return InvalidField("upper_triangle", absl::StrCat("the variance of element ", i, " is ",
                                                       variance, ", not in [1e-18, 1e12]"));
  }
  return absl::OkStatus();
}

// Tests the correlation matrix, whose scale does not depend on units: metres^2 beside rad^2.
template <typename Matrix>
bool IsWellCorrelated(const Matrix& covariance) {
  const auto scale = covariance.diagonal().cwiseSqrt().cwiseInverse().eval();
  const Matrix correlation = scale.asDiagonal() * covariance * scale.asDiagonal();
  return IsPositiveDefinite(
      Matrix(correlation - limits::kMinCorrelationEigenvalue * Matrix::Identity()));
}

template <typename Matrix>
void WriteTriangle(const Matrix& covariance, Triangle& triangle) {
  for (int row = 0; row < covariance.rows(); ++row) {
    for (int column = row; column < covariance.cols(); ++column) {
      triangle.Add(covariance(row, column));
    }
  }
}

template <typename Matrix>
absl::StatusOr<Matrix> ReadTriangle(const Triangle& triangle) {
  constexpr int kSize = Matrix::RowsAtCompileTime * (Matrix::RowsAtCompileTime + 1) / 2;
  if (triangle.size() != kSize) {
    return InvalidField("upper_triangle", absl::StrCat(triangle.size(), " numbers, not ", kSize));
  }
  Matrix covariance;
  int next = 0;
  for (int row = 0; row < covariance.rows(); ++row) {
    for (int column = row; column < covariance.cols(); ++column, ++next) {
      const double value = triangle.Get(next);
      if (!std::isfinite(value)) {
        return InvalidField(absl::StrCat("upper_triangle[", next, "]"), "not finite");
      }
      covariance(row, column) = value;
      covariance(column, row) = value;
    }
  }
  RETURN_IF_ERROR(ValidateVariances(covariance));
  if (!IsWellCorrelated(covariance)) {
    return InvalidField("upper_triangle", "not positive definite");
  }
  return covariance;
}

}  // namespace

v1::Vector3 ToProto(const Eigen::Vector3d& vector) {
  v1::Vector3 message;
  message.set_x(vector.x());
  message.set_y(vector.y());
  message.set_z(vector.z());
  return message;
}

v1::Pose ToProto(const Rigid3d& pose) {
  v1::Pose message;
  *message.mutable_position() = ToProto(pose.translation);
  v1::Quaternion& orientation = *message.mutable_orientation();
  orientation.set_x(pose.rotation.x());
  orientation.set_y(pose.rotation.y());
  orientation.set_z(pose.rotation.z());
  orientation.set_w(pose.rotation.w());
  return message;
}

v1::PoseCovariance ToProto(const Matrix6d& covariance) {
  v1::PoseCovariance message;
  WriteTriangle(covariance, *message.mutable_upper_triangle());
  return message;
}

v1::PointCovariance ToProto(const Eigen::Matrix3d& covariance) {
  v1::PointCovariance message;
  WriteTriangle(covariance, *message.mutable_upper_triangle());
  return message;
}

absl::StatusOr<Eigen::Vector3d> FromProto(const v1::Vector3& message) {
  const Eigen::Vector3d vector(message.x(), message.y(), message.z());
  RETURN_IF_ERROR(ValidateCoordinates(vector));
  return vector;
}

absl::Status ValidatePosition(const Eigen::Vector3d& position) {
  return AtField("position", ValidateCoordinates(position));
}

absl::StatusOr<Rigid3d> FromProto(const v1::Pose& message) {
  if (!message.has_position()) return InvalidField("position", "missing");
  if (!message.has_orientation()) return InvalidField("orientation", "missing");
  ASSIGN_OR_RETURN(const Eigen::Vector3d translation,
                   AtField("position", FromProto(message.position())));
  ASSIGN_OR_RETURN(const Eigen::Quaterniond rotation, UnitQuaternion(message.orientation()));
  return Rigid3d(rotation, translation);
}

absl::StatusOr<Matrix6d> FromProto(const v1::PoseCovariance& message) {
  return ReadTriangle<Matrix6d>(message.upper_triangle());
}

absl::StatusOr<Eigen::Matrix3d> FromProto(const v1::PointCovariance& message) {
  return ReadTriangle<Eigen::Matrix3d>(message.upper_triangle());
}

}  // namespace overtone
