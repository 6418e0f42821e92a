// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/geometry/rigid_alignment.h"

#include <cmath>

#include "Eigen/SVD"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

// Below this share of the largest singular value a direction counts as not seen: 1 um of width in 1
// m of length is, round-off is not.
constexpr double kRelativeRank = 1e-12;

struct CentredPair {
  Eigen::Vector3d source_mean = Eigen::Vector3d::Zero();
  Eigen::Vector3d target_mean = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();  // mean of (target - mean)(source - mean)^T
};

CentredPair Centre(const std::vector<Eigen::Vector3d>& source,
                   const std::vector<Eigen::Vector3d>& target) {
  CentredPair pair;
  const double n = static_cast<double>(source.size());
  for (size_t i = 0; i < source.size(); ++i) {
    pair.source_mean += source[i] / n;
    pair.target_mean += target[i] / n;
  }
  for (size_t i = 0; i < source.size(); ++i) {
    pair.covariance +=
        (target[i] - pair.target_mean) * (source[i] - pair.source_mean).transpose() / n;
  }
  return pair;
}

absl::Status Degenerate(absl::string_view why) {
  return absl::InvalidArgumentError(
      absl::StrCat("alignment: the points leave the rotation open: ", why));
}

// Umeyama's eq. 40 and 43, with the reflection undone along the weakest direction.
absl::StatusOr<Eigen::Quaterniond> Rotation(const Eigen::Matrix3d& covariance) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(covariance,
                                              Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& singular = svd.singularValues();
  const double negligible = kRelativeRank * singular(0);
  if (!(singular(1) > negligible)) return Degenerate("they lie on one line");
  const double sign = svd.matrixU().determinant() * svd.matrixV().determinant() < 0 ? -1 : 1;
  if (sign < 0 && singular(1) - singular(2) <= negligible) {
    return Degenerate("they are a mirror image of each other");
  }
  const Eigen::Vector3d signs(1, 1, sign);
  const Eigen::Matrix3d rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  return Eigen::Quaterniond(rotation).normalized();
}

// Maximises tr(Rz(yaw)^T * covariance) over the yaw.
absl::StatusOr<Eigen::Quaterniond> YawRotation(const Eigen::Matrix3d& covariance) {
  const double sine = covariance(1, 0) - covariance(0, 1);
  const double cosine = covariance(0, 0) + covariance(1, 1);
  if (!(std::hypot(sine, cosine) > kRelativeRank * covariance.norm())) {
    return Degenerate("they have no horizontal extent");
  }
  return ExpSO3(Eigen::Vector3d(0, 0, std::atan2(sine, cosine)));
}

}  // namespace

absl::StatusOr<Rigid3d> UmeyamaAlignment(const std::vector<Eigen::Vector3d>& source,
                                         const std::vector<Eigen::Vector3d>& target,
                                         AlignmentMode mode) {
  if (source.size() != target.size()) {
    return absl::InvalidArgumentError(absl::StrCat("alignment: ", source.size(), " source and ",
                                                   target.size(), " target points"));
  }
  if (source.empty()) return absl::InvalidArgumentError("alignment: no points");
  const CentredPair pair = Centre(source, target);
  if (!pair.covariance.allFinite()) {
    return absl::InvalidArgumentError("alignment: a point is not finite");
  }
  ASSIGN_OR_RETURN(const Eigen::Quaterniond rotation, mode == AlignmentMode::kSe3
                                                          ? Rotation(pair.covariance)
                                                          : YawRotation(pair.covariance));
  return Rigid3d(rotation, pair.target_mean - rotation * pair.source_mean);
}

}  // namespace overtone
