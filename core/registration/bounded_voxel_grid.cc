// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/bounded_voxel_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "overtone/core/registration/voxel_grid.h"

namespace overtone {

void BoundedVoxelGrid::Add(const Eigen::Vector3d& point, float intensity) {
  if (!has_origin_ && point.allFinite()) {
    origin_ = point;
    has_origin_ = true;
  }
  Voxel single;
  single.mean = (point - origin_).cast<float>();
  single.intensity = intensity;
  single.num_points = 1;
  Merge(single);
  while (static_cast<int64_t>(voxels_.size()) > max_voxels_) Enlarge();
}

void BoundedVoxelGrid::Merge(const Voxel& voxel) {
  const std::optional<uint64_t> key = VoxelKey(voxel.mean, static_cast<float>(voxel_m_));
  if (!key) {
    left_out_ += voxel.num_points;
    return;
  }
  Voxel& sum = voxels_[*key];
  const uint64_t num_points = uint64_t{sum.num_points} + voxel.num_points;
  const float share = static_cast<float>(voxel.num_points) / static_cast<float>(num_points);
  sum.mean += share * (voxel.mean - sum.mean);
  sum.intensity += share * (voxel.intensity - sum.intensity);
  sum.num_points =
      static_cast<uint32_t>(std::min<uint64_t>(num_points, std::numeric_limits<uint32_t>::max()));
}

// A mean moves as a whole into the larger cube that it lies in. Never two tables at once: they are
// the most of the memory.
void BoundedVoxelGrid::Enlarge() {
  voxel_m_ *= std::sqrt(2.0);
  std::vector<Voxel> smaller;
  smaller.reserve(voxels_.size());
  for (const auto& [key, voxel] : voxels_) smaller.push_back(voxel);
  voxels_ = Voxels();
  for (const Voxel& voxel : smaller) Merge(voxel);
}

}  // namespace overtone
