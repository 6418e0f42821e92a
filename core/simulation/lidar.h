// SPDX-License-Identifier: Apache-2.0
// A spinning LiDAR, or a planar laser, in a simulated world.
#ifndef OVERTONE_CORE_SIMULATION_LIDAR_H_
#define OVERTONE_CORE_SIMULATION_LIDAR_H_

#include <vector>

#include "Eigen/Core"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/geometry/se3.h"
#include "overtone/core/graph/point_cloud.h"
#include "overtone/core/simulation/random.h"
#include "overtone/core/simulation/world.h"

namespace overtone {

struct LidarOptions {
  int rings = 16;                   // 1..256
  double vertical_fov_deg = 30;     // from the lowest ring to the highest, level between; 0..170
  int columns = 900;                // of a full turn, 4..10000
  double horizontal_fov_deg = 360;  // about straight ahead, 1..360
  double min_range_m = 0.3;         // shorter returns are dropped
  double max_range_m = 50;          // above min_range_m, up to 1000
  double range_sigma_m = 0.02;      // white, along the ray, 0..1
  double mounting_height_m = 0.3;   // above the body's origin, on its z axis, -10..10

  // InvalidArgument naming the member.
  absl::Status Validate() const;

  // A planar laser: one level ring, four beams a degree over 270 degrees, 30 m.
  static LidarOptions Planar();
};

class Lidar {
 public:
  // InvalidArgument: options.Validate().
  static absl::StatusOr<Lidar> Create(const LidarOptions& options);

  // What it sees from a body that stands still: column by column, in each from the lowest ring;
  // rays without return leave no point. In the body frame, no intensities.
  PointCloud Scan(const World& world, const Rigid3d& world_from_body, Random& random) const;

  int num_rays() const { return static_cast<int>(directions_in_body_.size()); }

 private:
  explicit Lidar(const LidarOptions& options);

  LidarOptions options_;
  std::vector<Eigen::Vector3d> directions_in_body_;  // unit
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_LIDAR_H_
