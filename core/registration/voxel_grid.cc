// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/voxel_grid.h"

#include <algorithm>
#include <cmath>

#include "absl/container/flat_hash_map.h"

namespace overtone {
namespace {

constexpr double kHalfRange = 1 << 20;

// Numbers the occupied cubes as they are met: the cube of each point, -1 without a key.
struct VoxelNumbering {
  std::vector<int> voxel_of_point;
  int num_voxels = 0;
};

VoxelNumbering NumberVoxels(const std::vector<Eigen::Vector3f>& points, float voxel_size_m) {
  VoxelNumbering numbering;
  numbering.voxel_of_point.reserve(points.size());
  absl::flat_hash_map<uint64_t, int> number_of_key;
  number_of_key.reserve(points.size() / 4);
  for (const Eigen::Vector3f& point : points) {
    const std::optional<uint64_t> key = VoxelKey(point, voxel_size_m);
    if (!key) {
      numbering.voxel_of_point.push_back(-1);
      continue;
    }
    const auto [entry, is_new] = number_of_key.try_emplace(*key, numbering.num_voxels);
    if (is_new) ++numbering.num_voxels;
    numbering.voxel_of_point.push_back(entry->second);
  }
  return numbering;
}

}  // namespace

std::optional<uint64_t> VoxelKey(const Eigen::Vector3f& point, float voxel_size_m) {
  uint64_t key = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double index = std::floor(static_cast<double>(point[axis]) / voxel_size_m);
    if (!(std::abs(index) < kHalfRange)) return std::nullopt;  // NaN too
    key = key << 21 | static_cast<uint64_t>(index + kHalfRange);
  }
  return key;
}

std::vector<Eigen::Vector3f> VoxelCentroids(const std::vector<Eigen::Vector3f>& points,
                                            float voxel_size_m) {
  const VoxelNumbering numbering = NumberVoxels(points, voxel_size_m);
  std::vector<Eigen::Vector3d> sums(numbering.num_voxels, Eigen::Vector3d::Zero());
  std::vector<int> counts(numbering.num_voxels, 0);
  for (size_t i = 0; i < points.size(); ++i) {
    const int voxel = numbering.voxel_of_point[i];
    if (voxel < 0) continue;
    sums[voxel] += points[i].cast<double>();
    ++counts[voxel];
  }
  std::vector<Eigen::Vector3f> centroids(numbering.num_voxels);
  for (int voxel = 0; voxel < numbering.num_voxels; ++voxel) {
    centroids[voxel] = (sums[voxel] / counts[voxel]).cast<float>();
  }
  return centroids;
}

std::vector<float> VoxelShares(const std::vector<Eigen::Vector3f>& points, float voxel_size_m,
                               int least) {
  const VoxelNumbering numbering = NumberVoxels(points, voxel_size_m);
  std::vector<int> counts(numbering.num_voxels, 0);
  for (const int voxel : numbering.voxel_of_point) {
    if (voxel >= 0) ++counts[voxel];
  }
  std::vector<float> shares;
  shares.reserve(points.size());
  for (const int voxel : numbering.voxel_of_point) {
    shares.push_back(voxel < 0 ? 0 : 1.0f / std::max(least, counts[voxel]));
  }
  return shares;
}

}  // namespace overtone
