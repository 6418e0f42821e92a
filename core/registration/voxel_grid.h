// SPDX-License-Identifier: Apache-2.0
// Thins points out to one for each cube of a grid that holds any: their mean.
#ifndef OVERTONE_CORE_REGISTRATION_VOXEL_GRID_H_
#define OVERTONE_CORE_REGISTRATION_VOXEL_GRID_H_

#include <cstdint>
#include <optional>
#include <vector>

#include "Eigen/Core"

namespace overtone {

// The cube [i, i + 1) * voxel_size along each axis, as one number: 21 bits for each axis. Nothing
// for a point that is not finite or 2^20 cubes (at 0.25 m: 262 km) or more from the origin.
std::optional<uint64_t> VoxelKey(const Eigen::Vector3f& point, float voxel_size_m);

// One mean for each occupied cube, in the order in which the cubes were first met. Points without a
// key are left out. voxel_size_m > 0. O(n).
std::vector<Eigen::Vector3f> VoxelCentroids(const std::vector<Eigen::Vector3f>& points,
                                            float voxel_size_m);

// For each point its share of its cube: 1 / (number of points in it, counted as `least` where there
// are fewer); 0 for one without a key. O(n).
std::vector<float> VoxelShares(const std::vector<Eigen::Vector3f>& points, float voxel_size_m,
                               int least);

}  // namespace overtone

#endif  // OVERTONE_CORE_REGISTRATION_VOXEL_GRID_H_
