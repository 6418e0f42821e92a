// SPDX-License-Identifier: Apache-2.0
// A point cloud made ready for registration at one resolution. Made once, used in many pairs.
#ifndef OVERTONE_CORE_REGISTRATION_REGISTRATION_CLOUD_H_
#define OVERTONE_CORE_REGISTRATION_REGISTRATION_CLOUD_H_

#include <memory>
#include <vector>

#include "Eigen/Core"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/graph/point_cloud.h"
#include "overtone/core/registration/kd_tree.h"
#include "overtone/core/registration/normal_estimation.h"

namespace overtone {

struct RegistrationCloudOptions {
  double voxel_size_m = 0.25;
  int num_neighbors = 15;  // for a normal, the point itself included
  // A cloud whose z spans no more is that of a planar laser: its points are brought to z = 0 and
  // its normals are level.
  double planar_thickness_m = 0.02;
  // Points in one cube of this size err together (same surface, same neighbours, same calibration)
  // and count as one measurement in the covariance of a registration.
  double correlation_length_m = 1.0;

  absl::Status Validate() const;  // InvalidArgument naming the member
};

// Immutable; any number of threads may use it at once.
class RegistrationCloud {
 public:
  // InvalidArgument: options; fewer than num_neighbors points left after thinning, points that are
  // not finite or too far (voxel_grid.h) not counted.
  static absl::StatusOr<std::shared_ptr<const RegistrationCloud>> Create(
      const std::vector<Eigen::Vector3f>& points, const RegistrationCloudOptions& options);

  int size() const { return static_cast<int>(points_.size()); }
  bool planar() const { return planar_; }
  double voxel_size_m() const { return voxel_size_m_; }
  const std::vector<Eigen::Vector3f>& points() const { return points_; }
  const std::vector<SurfaceNormal>& normals() const { return normals_; }
  // For each point the part of an independent measurement it stands for: its share of the points
  // within correlation_length_m, no more than one in num_neighbors, of which its normal is made.
  const std::vector<float>& independence() const { return independence_; }
  const KdTree& tree() const { return tree_; }

 private:
  RegistrationCloud(std::vector<Eigen::Vector3f> points, bool planar,
                    const RegistrationCloudOptions& options);

  const double voxel_size_m_;
  const bool planar_;
  const std::vector<Eigen::Vector3f> points_;
  const KdTree tree_;
  const std::vector<SurfaceNormal> normals_;
  const std::vector<float> independence_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_REGISTRATION_REGISTRATION_CLOUD_H_
