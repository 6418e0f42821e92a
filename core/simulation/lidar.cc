// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/lidar.h"

#include <cmath>

#include "overtone/core/common/status_macros.h"
#include "overtone/core/simulation/option_range.h"

namespace overtone {

absl::Status LidarOptions::Validate() const {
  const OptionRange range("LidarOptions");
  RETURN_IF_ERROR(range.Check("rings", rings, 1, 256));
  RETURN_IF_ERROR(range.Check("vertical_fov_deg", vertical_fov_deg, 0, 170));
  RETURN_IF_ERROR(range.Check("columns", columns, 4, 10000));
  RETURN_IF_ERROR(range.Check("horizontal_fov_deg", horizontal_fov_deg, 1, 360));
  RETURN_IF_ERROR(range.Check("min_range_m", min_range_m, 0, 1000));
  RETURN_IF_ERROR(range.Check("max_range_m", max_range_m, min_range_m, 1000));
  RETURN_IF_ERROR(range.Check("range_sigma_m", range_sigma_m, 0, 1));
  return range.Check("mounting_height_m", mounting_height_m, -10, 10);
}

LidarOptions LidarOptions::Planar() {
  LidarOptions options;
  options.rings = 1;
  options.vertical_fov_deg = 0;
  options.columns = 1440;
  options.horizontal_fov_deg = 270;
  options.max_range_m = 30;
  return options;
}

absl::StatusOr<Lidar> Lidar::Create(const LidarOptions& options) {
  RETURN_IF_ERROR(options.Validate());
  return Lidar(options);
}

Lidar::Lidar(const LidarOptions& options) : options_(options) {
  const double to_rad = M_PI / 180;
  const double resolution_deg = 360.0 / options.columns;
  const int columns =
      std::max(1, static_cast<int>(std::lround(options.horizontal_fov_deg / resolution_deg)));
  for (int column = 0; column < columns; ++column) {
    const double azimuth = (column - 0.5 * (columns - 1)) * resolution_deg * to_rad;
    for (int ring = 0; ring < options.rings; ++ring) {
      const double share = options.rings == 1 ? 0 : ring / (options.rings - 1.0) - 0.5;
      const double elevation = share * options.vertical_fov_deg * to_rad;
      directions_in_body_.emplace_back(std::cos(elevation) * std::cos(azimuth),
                                       std::cos(elevation) * std::sin(azimuth),
                                       std::sin(elevation));
    }
  }
}

PointCloud Lidar::Scan(const World& world, const Rigid3d& world_from_body, Random& random) const {
  const Eigen::Vector3d mounting(0, 0, options_.mounting_height_m);
  const Eigen::Vector3d origin = world_from_body * mounting;
  const Eigen::Matrix3d rotation = world_from_body.rotation.toRotationMatrix();
  PointCloud cloud;
  cloud.points.reserve(directions_in_body_.size());
  for (const Eigen::Vector3d& direction : directions_in_body_) {
    const double true_range = world.CastRay(origin, rotation * direction, options_.max_range_m);
    if (!std::isfinite(true_range)) continue;
    const double range = true_range + options_.range_sigma_m * random.Normal();
    if (range < options_.min_range_m) continue;
    cloud.points.push_back((mounting + range * direction).cast<float>());
  }
  return cloud;
}

}  // namespace overtone
