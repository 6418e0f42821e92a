// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/coarse_to_fine.h"

#include <cmath>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/registration/gicp.h"
#include "overtone/core/registration/overlap.h"

namespace overtone {
namespace {

// In voxels; see GicpOptions.tolerance_m.
constexpr double kTolerance = 0.002;

// Where surfaces leave a direction open, turned starts end elsewhere with the same overlap: the
// guess is to be preferred.
constexpr double kClearlyMore = 0.05;

GicpOptions OptionsAt(double voxel_size_m, const CoarseToFineOptions& options) {
  GicpOptions gicp;
  gicp.max_correspondence_distance_m = options.reach * voxel_size_m;
  gicp.kernel_width_m = options.kernel_width * voxel_size_m;
  gicp.max_iterations = options.max_iterations;
  gicp.tolerance_m = kTolerance * voxel_size_m;
  return gicp;
}

RegistrationCloudOptions CloudOptionsAt(double voxel_size_m, const CoarseToFineOptions& options) {
  RegistrationCloudOptions cloud;
  cloud.voxel_size_m = voxel_size_m;
  cloud.num_neighbors = options.num_neighbors;
  cloud.planar_thickness_m = options.planar_thickness_m;
  cloud.correlation_length_m = options.correlation_length_m;
  return cloud;
}

// The part of a pose that planar lasers see.
Rigid3d LevelPart(const Rigid3d& pose) {
  const Eigen::Vector3d x_axis = pose.rotation * Eigen::Vector3d::UnitX();
  return Rigid3d(ExpSO3(Eigen::Vector3d(0, 0, std::atan2(x_axis.y(), x_axis.x()))),
                 Eigen::Vector3d(pose.translation.x(), pose.translation.y(), 0));
}

// The start that overlaps most after registration at the coarsest resolution.
GicpEstimate BestStart(const RegistrationCloud& source, const RegistrationCloud& target,
                       const Rigid3d& guess, const CoarseToFineOptions& options) {
  const GicpOptions gicp = OptionsAt(source.voxel_size_m(), options);
  GicpEstimate best = Gicp(source, target, guess, gicp);
  if (options.yaw_offsets_rad.empty()) return best;
  const double distance_m = source.voxel_size_m();
  double most = Overlap(source, target, best.target_from_source, distance_m);
  for (const double yaw : options.yaw_offsets_rad) {
    const Rigid3d turn(ExpSO3(Eigen::Vector3d(0, 0, yaw)), Eigen::Vector3d::Zero());
    const GicpEstimate estimate = Gicp(source, target, guess * turn, gicp);
    const double overlap = Overlap(source, target, estimate.target_from_source, distance_m);
    if (overlap <= most + kClearlyMore) continue;
    most = overlap;
    best = estimate;
  }
  return best;
}

// A coarser result, unless it overlaps clearly less than the guess that it came from: few points or
// a narrow field of view can lead a coarse registration away from a good guess.
const Rigid3d& BetterStart(const RegistrationCloud& source, const RegistrationCloud& target,
                           const Rigid3d& coarser, const Rigid3d& guess) {
  const double distance_m = source.voxel_size_m();
  const double overlap = Overlap(source, target, coarser, distance_m);
  return Overlap(source, target, guess, distance_m) > overlap + kClearlyMore ? guess : coarser;
}

absl::Status CheckLevels(const RegistrationPyramid& pyramid, const CoarseToFineOptions& options) {
  bool same = pyramid.levels().size() == options.voxel_sizes_m.size();
  for (size_t level = 0; same && level < options.voxel_sizes_m.size(); ++level) {
    same = pyramid.levels()[level]->voxel_size_m() == options.voxel_sizes_m[level];
  }
  if (same) return absl::OkStatus();
  return absl::InvalidArgumentError(
      "registration: CoarseToFineOptions.voxel_sizes_m are not those of the pyramid");
}

}  // namespace

absl::Status CoarseToFineOptions::Validate() const {
  if (voxel_sizes_m.empty()) {
    return absl::InvalidArgumentError("CoarseToFineOptions.voxel_sizes_m is empty");
  }
  for (size_t level = 0; level < voxel_sizes_m.size(); ++level) {
    RETURN_IF_ERROR(CloudOptionsAt(voxel_sizes_m[level], *this).Validate());
    RETURN_IF_ERROR(OptionsAt(voxel_sizes_m[level], *this).Validate());
    if (level > 0 && !(voxel_sizes_m[level] < voxel_sizes_m[level - 1])) {
      return absl::InvalidArgumentError("CoarseToFineOptions.voxel_sizes_m: must decrease");
    }
  }
  for (const double yaw : yaw_offsets_rad) {
    if (!std::isfinite(yaw)) {
      return absl::InvalidArgumentError("CoarseToFineOptions.yaw_offsets_rad: not finite");
    }
  }
  if (!(overlap_distance > 0 && std::isfinite(overlap_distance))) {
    return absl::InvalidArgumentError(absl::StrCat(
        "CoarseToFineOptions.overlap_distance = ", overlap_distance, ": must be positive"));
  }
  return covariance.Validate();
}

CoarseToFineOptions IndoorLaserOptions() {
  CoarseToFineOptions options;
  options.voxel_sizes_m = {0.8, 0.4, 0.2, 0.1};
  options.num_neighbors = 10;
  options.correlation_length_m = 0.5;
  return options;
}

absl::StatusOr<RegistrationPyramid> RegistrationPyramid::Create(
    const PointCloud& cloud, const CoarseToFineOptions& options) {
  RETURN_IF_ERROR(options.Validate());
  RegistrationPyramid pyramid;
  for (const double voxel_size_m : options.voxel_sizes_m) {
    ASSIGN_OR_RETURN(
        std::shared_ptr<const RegistrationCloud> level,
        RegistrationCloud::Create(cloud.points, CloudOptionsAt(voxel_size_m, options)));
    pyramid.levels_.push_back(std::move(level));
  }
  return pyramid;
}

absl::StatusOr<RegistrationResult> RegisterCoarseToFine(const RegistrationPyramid& source,
                                                        const RegistrationPyramid& target,
                                                        const Rigid3d& guess,
                                                        const CoarseToFineOptions& options) {
  RETURN_IF_ERROR(options.Validate());
  RETURN_IF_ERROR(CheckLevels(source, options));
  RETURN_IF_ERROR(CheckLevels(target, options));
  if (!guess.ToMatrix().allFinite()) {
    return absl::InvalidArgumentError("registration: the guess is not finite");
  }
  const bool planar = source.finest().planar() && target.finest().planar();
  const Rigid3d start = planar ? LevelPart(guess) : guess;
  GicpEstimate estimate = BestStart(*source.levels()[0], *target.levels()[0], start, options);
  RegistrationResult result;
  result.iterations = estimate.iterations;
  for (size_t level = 1; level < options.voxel_sizes_m.size(); ++level) {
    const RegistrationCloud& level_source = *source.levels()[level];
    const RegistrationCloud& level_target = *target.levels()[level];
    estimate = Gicp(level_source, level_target,
                    BetterStart(level_source, level_target, estimate.target_from_source, start),
                    OptionsAt(options.voxel_sizes_m[level], options));
    result.iterations += estimate.iterations;
  }
  result.converged = estimate.converged;
  result.overlap = Overlap(source.finest(), target.finest(), estimate.target_from_source,
                           options.OverlapDistance());
  const RegistrationCovariance covariance =
      EstimateCovariance(source.finest(), target.finest(), estimate.target_from_source,
                         estimate.target_of_source, options.OverlapDistance(), options.covariance);
  result.residual_m = covariance.residual_m;
  result.open_directions = covariance.open_directions;
  // What planar clouds do not see was held: put back, it turns the tangent.
  const Rigid3d held = start.Inverse() * guess;
  const Matrix6d tangent = Adjoint(held.Inverse());
  result.target_from_source = estimate.target_from_source * held;
  result.covariance = tangent * covariance.covariance * tangent.transpose();
  return result;
}

}  // namespace overtone
