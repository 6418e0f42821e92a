// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/registration_cloud.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/registration/voxel_grid.h"

namespace overtone {
namespace {

// After thinning: a mean of equal heights may round, so the thickness has to be above that.
bool IsPlanar(const std::vector<Eigen::Vector3f>& points, double thickness_m) {
  const auto [lowest, highest] = std::minmax_element(
      points.begin(), points.end(), [](const auto& a, const auto& b) { return a.z() < b.z(); });
  return highest->z() - lowest->z() <= thickness_m;
}

absl::Status CheckPositive(double value, absl::string_view name) {
  if (value > 0 && std::isfinite(value)) return absl::OkStatus();
  return absl::InvalidArgumentError(
      absl::StrCat("RegistrationCloudOptions.", name, " = ", value, ": must be positive"));
}

}  // namespace

absl::Status RegistrationCloudOptions::Validate() const {
  RETURN_IF_ERROR(CheckPositive(voxel_size_m, "voxel_size_m"));
  RETURN_IF_ERROR(CheckPositive(planar_thickness_m, "planar_thickness_m"));
  RETURN_IF_ERROR(CheckPositive(correlation_length_m, "correlation_length_m"));
  if (num_neighbors < 3) {
    return absl::InvalidArgumentError(absl::StrCat(
        "RegistrationCloudOptions.num_neighbors = ", num_neighbors, ": must be at least 3"));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::shared_ptr<const RegistrationCloud>> RegistrationCloud::Create(
    const std::vector<Eigen::Vector3f>& points, const RegistrationCloudOptions& options) {
  RETURN_IF_ERROR(options.Validate());
  std::vector<Eigen::Vector3f> thinned =
      VoxelCentroids(points, static_cast<float>(options.voxel_size_m));
  if (static_cast<int>(thinned.size()) < options.num_neighbors) {
    return absl::InvalidArgumentError(absl::StrCat(
        "registration: of ", points.size(), " points ", thinned.size(), " are left at ",
        options.voxel_size_m, " m, fewer than the ", options.num_neighbors, " a normal needs"));
  }
  const bool planar = IsPlanar(thinned, options.planar_thickness_m);
  if (planar) {
    for (Eigen::Vector3f& point : thinned) point.z() = 0;
  }
  return std::shared_ptr<const RegistrationCloud>(
      new RegistrationCloud(std::move(thinned), planar, options));
}

RegistrationCloud::RegistrationCloud(std::vector<Eigen::Vector3f> points, bool planar,
                                     const RegistrationCloudOptions& options)
    : voxel_size_m_(options.voxel_size_m),
      planar_(planar),
      points_(std::move(points)),
      tree_(points_),
      normals_(EstimateNormals(points_, tree_, options.num_neighbors,
                               planar ? SurfaceKind::kOutline : SurfaceKind::kSurface)),
      independence_(VoxelShares(points_, static_cast<float>(options.correlation_length_m),
                                options.num_neighbors)) {}

}  // namespace overtone
