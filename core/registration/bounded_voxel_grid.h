// SPDX-License-Identifier: Apache-2.0
// Thins out more points than fit into memory, as they come: one mean for each cube of a grid that
// holds any, and cubes large enough that there are no more of them than allowed.
#ifndef OVERTONE_CORE_REGISTRATION_BOUNDED_VOXEL_GRID_H_
#define OVERTONE_CORE_REGISTRATION_BOUNDED_VOXEL_GRID_H_

#include <cstdint>

#include "Eigen/Core"
#include "absl/container/flat_hash_map.h"

namespace overtone {

// Memory: 38 to 75 bytes for each cube once all is in; while the table grows, half as much again.
class BoundedVoxelGrid {
 public:
  struct Voxel {
    Eigen::Vector3f mean = Eigen::Vector3f::Zero();  // metres, from origin()
    float intensity = 0;                             // mean
    uint32_t num_points = 0;                         // stays at its largest value
  };
  using Voxels = absl::flat_hash_map<uint64_t, Voxel>;  // by the key of the cube

  // Both above 0.
  BoundedVoxelGrid(double voxel_m, int64_t max_voxels)
      : voxel_m_(voxel_m), max_voxels_(max_voxels) {}

  // The first point settles the origin, so that floats are fine enough wherever the map lies. A
  // point that is not finite, or 2^20 cubes or more away along an axis, is counted and left out.
  void Add(const Eigen::Vector3d& point, float intensity);

  // The size that the cubes came to, in steps of sqrt(2): of a surface's cubes half are left.
  double voxel_m() const { return voxel_m_; }
  const Eigen::Vector3d& origin() const { return origin_; }
  int64_t left_out() const { return left_out_; }
  const Voxels& voxels() const { return voxels_; }

 private:
  void Merge(const Voxel& voxel);
  void Enlarge();

  double voxel_m_;
  const int64_t max_voxels_;
  bool has_origin_ = false;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  int64_t left_out_ = 0;
  Voxels voxels_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_REGISTRATION_BOUNDED_VOXEL_GRID_H_
