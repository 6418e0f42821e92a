// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/geometry/trajectory_error.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

absl::Status CheckLengths(const std::vector<Rigid3d>& estimate,
                          const std::vector<Rigid3d>& reference) {
  if (estimate.size() == reference.size()) return absl::OkStatus();
  return absl::InvalidArgumentError(absl::StrCat("trajectory error: ", estimate.size(),
                                                 " estimated and ", reference.size(),
                                                 " reference poses"));
}

std::vector<Eigen::Vector3d> Positions(const std::vector<Rigid3d>& poses) {
  std::vector<Eigen::Vector3d> positions;
  positions.reserve(poses.size());
  for (const Rigid3d& pose : poses) positions.push_back(pose.translation);
  return positions;
}

double RootMeanSquare(const std::vector<double>& values) {
  const double sum = std::inner_product(values.begin(), values.end(), values.begin(), 0.0);
  return std::sqrt(sum / values.size());
}

// Mean of the two middle values when their number is even.
double Median(std::vector<double> values) {
  const size_t middle = values.size() / 2;
  std::nth_element(values.begin(), values.begin() + middle, values.end());
  if (values.size() % 2 == 1) return values[middle];
  return 0.5 * (values[middle] + *std::max_element(values.begin(), values.begin() + middle));
}

double Angle(const Eigen::Quaterniond& rotation) { return LogSO3(rotation).norm(); }

// Rotation about z in the swing-twist split, in (-pi, pi].
double YawAngle(const Eigen::Quaterniond& rotation) {
  const double sign = rotation.w() < 0 ? -1 : 1;
  return 2 * std::atan2(sign * rotation.z(), sign * rotation.w());
}

}  // namespace

absl::StatusOr<TrajectoryError> AbsoluteTrajectoryError(const std::vector<Rigid3d>& estimate,
                                                        const std::vector<Rigid3d>& reference,
                                                        AlignmentMode mode) {
  RETURN_IF_ERROR(CheckLengths(estimate, reference));
  TrajectoryError error;
  ASSIGN_OR_RETURN(error.reference_from_estimate,
                   UmeyamaAlignment(Positions(estimate), Positions(reference), mode));
  std::vector<double> angles;
  for (size_t i = 0; i < estimate.size(); ++i) {
    const Rigid3d aligned = error.reference_from_estimate * estimate[i];
    error.per_pose_m.push_back((aligned.translation - reference[i].translation).norm());
    angles.push_back(Angle(reference[i].rotation.conjugate() * aligned.rotation));
  }
  const std::vector<double>& distances = error.per_pose_m;
  error.rmse_m = RootMeanSquare(distances);
  error.mean_m = std::accumulate(distances.begin(), distances.end(), 0.0) / distances.size();
  error.median_m = Median(distances);
  error.max_m = *std::max_element(distances.begin(), distances.end());
  error.rotation_rmse_rad = RootMeanSquare(angles);
  return error;
}

absl::StatusOr<RelativeError> RelativePoseError(const std::vector<Rigid3d>& estimate,
                                                const std::vector<Rigid3d>& reference, int delta) {
  RETURN_IF_ERROR(CheckLengths(estimate, reference));
  if (delta < 1 || static_cast<size_t>(delta) >= estimate.size()) {
    return absl::InvalidArgumentError(
        absl::StrCat("relative pose error: delta ", delta, " with ", estimate.size(), " poses"));
  }
  RelativeError error;
  std::vector<double> angles, yaws;
  for (size_t i = 0, j = delta; j < estimate.size(); ++i, ++j) {
    const Rigid3d expected = reference[i].Inverse() * reference[j];
    const Rigid3d difference = expected.Inverse() * (estimate[i].Inverse() * estimate[j]);
    const Eigen::Quaterniond difference_in_world =
        reference[j].rotation * difference.rotation * reference[j].rotation.conjugate();
    error.per_pair_m.push_back(difference.translation.norm());
    angles.push_back(Angle(difference.rotation));
    yaws.push_back(YawAngle(difference_in_world));
  }
  error.translation_rmse_m = RootMeanSquare(error.per_pair_m);
  error.rotation_rmse_rad = RootMeanSquare(angles);
  error.yaw_rmse_rad = RootMeanSquare(yaws);
  return error;
}

}  // namespace overtone
