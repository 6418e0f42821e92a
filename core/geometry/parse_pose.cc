// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/geometry/parse_pose.h"

#include <array>
#include <cmath>

#include "Eigen/SVD"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/parse_number.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

absl::Status CheckPosition(const Eigen::Vector3d& position) {
  if (position.allFinite() && position.cwiseAbs().maxCoeff() <= kMaxPosition_m) {
    return absl::OkStatus();
  }
  return absl::InvalidArgumentError(absl::StrCat("position (", position.x(), ", ", position.y(),
                                                 ", ", position.z(), ") is not within +-",
                                                 kMaxPosition_m, " m"));
}

}  // namespace

absl::StatusOr<Rigid3d> CheckedPose(const Eigen::Vector3d& position, const Eigen::Vector4d& xyzw) {
  RETURN_IF_ERROR(CheckPosition(position));
  const double length = xyzw.norm();
  if (!(std::abs(length - 1) <= kRotationTolerance)) {  // NaN fails, too
    return absl::InvalidArgumentError(
        absl::StrCat("quaternion has length ", length, ", not 1 within ", kRotationTolerance));
  }
  return Rigid3d(Eigen::Quaterniond(Eigen::Vector4d(xyzw / length)), position);
}

absl::StatusOr<Rigid3d> CheckedPose(const Eigen::Matrix<double, 3, 4>& matrix) {
  RETURN_IF_ERROR(CheckPosition(matrix.col(3)));
  const Eigen::Matrix3d rotation = matrix.leftCols<3>();
  const Eigen::Matrix3d defect = rotation.transpose() * rotation - Eigen::Matrix3d::Identity();
  if (!(defect.cwiseAbs().maxCoeff() <= kRotationTolerance) || rotation.determinant() < 0) {
    return absl::InvalidArgumentError("the left 3 x 3 block is not a rotation matrix");
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(rotation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d nearest = svd.matrixU() * svd.matrixV().transpose();
  return Rigid3d(Eigen::Quaterniond(nearest).normalized(), matrix.col(3));
}

absl::StatusOr<Rigid3d> ParsePose(absl::Span<const absl::string_view> fields) {
  std::array<double, 7> v;
  RETURN_IF_ERROR(ParseFiniteDoubles(fields, absl::MakeSpan(v)));
  return CheckedPose(Eigen::Vector3d(v[0], v[1], v[2]), Eigen::Vector4d(v[3], v[4], v[5], v[6]));
}

}  // namespace overtone
