// SPDX-License-Identifier: Apache-2.0
// Scans of small worlds made of flat patches, with exact poses: for tests and benchmarks of
// registration.
#ifndef OVERTONE_TESTS_SUPPORT_SIMULATED_SCANS_H_
#define OVERTONE_TESTS_SUPPORT_SIMULATED_SCANS_H_

#include <cmath>
#include <limits>
#include <vector>

#include "overtone/core/geometry/se3.h"
#include "overtone/core/graph/point_cloud.h"
#include "overtone/core/simulation/random.h"

namespace overtone {

// The parallelogram corner + s * edge_a + t * edge_b, s and t in [0, 1]; seen from both sides.
struct Patch {
  Eigen::Vector3d corner, edge_a, edge_b;
};

using PatchWorld = std::vector<Patch>;

// The six faces of an axis-aligned box, turned by `yaw` about its middle.
inline void AddBox(const Eigen::Vector3d& middle, const Eigen::Vector3d& size, double yaw,
                   PatchWorld& world) {
  const Eigen::Quaterniond rotation = ExpSO3(Eigen::Vector3d(0, 0, yaw));
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    const Eigen::Vector3d edge_a = size[a] * Eigen::Vector3d::Unit(a);
    const Eigen::Vector3d edge_b = size[b] * Eigen::Vector3d::Unit(b);
    for (const double side : {-0.5, 0.5}) {
      const Eigen::Vector3d corner =
          side * size[axis] * Eigen::Vector3d::Unit(axis) - edge_a / 2 - edge_b / 2;
      world.push_back({middle + rotation * corner, rotation * edge_a, rotation * edge_b});
    }
  }
}

// Floor at z = 0. A furnished room of 8 x 6 x 3 m.
inline PatchWorld RoomWorld() {
  PatchWorld world;
  AddBox({0, 0, 1.5}, {8, 6, 3}, 0, world);
  AddBox({2.5, 1.8, 0.9}, {1.2, 0.6, 1.8}, 0, world);
  AddBox({-2.8, -1.5, 0.4}, {1.5, 0.9, 0.8}, 0.5, world);
  AddBox({-1.0, 2.4, 1.0}, {0.5, 0.5, 2.0}, 0.2, world);
  return world;
}

// 3 m wide and high, along x, its ends out of sight.
inline PatchWorld CorridorWorld() {
  PatchWorld world;
  AddBox({0, 0, 1.5}, {1000, 3, 3}, 0, world);
  return world;
}

// 40 x 30 x 8 m with pillars and crates.
inline PatchWorld HallWorld() {
  PatchWorld world;
  AddBox({0, 0, 4}, {40, 30, 8}, 0, world);
  for (const double x : {-12.0, 0.0, 12.0}) {
    for (const double y : {-8.0, 8.0}) AddBox({x, y, 4}, {0.8, 0.8, 8}, 0, world);
  }
  AddBox({6, -3, 1}, {3, 2, 2}, 0.3, world);
  AddBox({-7, 4, 0.8}, {2, 4, 1.6}, -0.6, world);
  AddBox({-15, -11, 1.5}, {4, 3, 3}, 0.1, world);
  AddBox({16, 10, 1}, {2, 6, 2}, 0.8, world);
  return world;
}

inline PatchWorld WallWorld() { return {{{5, -500, -500}, {0, 1000, 0}, {0, 0, 1000}}}; }

struct Scanner {
  int num_rings = 32;
  int num_columns = 900;  // over the full turn
  double lowest_rad = -0.5;
  double highest_rad = 0.5;
  double max_range_m = 30;
  double range_sigma_m = 0.02;
};

// One ring at the sensor's height.
inline Scanner PlanarScanner() { return {1, 720, 0, 0, 30, 0.02}; }

inline double RangeTo(const Patch& patch, const Eigen::Vector3d& origin,
                      const Eigen::Vector3d& direction) {
  Eigen::Matrix3d columns;
  columns << patch.edge_a, patch.edge_b, -direction;
  const Eigen::Vector3d solution = columns.inverse() * (origin - patch.corner);
  const bool hit = solution(0) >= 0 && solution(0) <= 1 && solution(1) >= 0 && solution(1) <= 1 &&
                   solution(2) > 0;  // false for NaN: a ray within the patch
  return hit ? solution(2) : std::numeric_limits<double>::infinity();
}

// What the scanner at world_from_sensor sees, in the sensor's frame; rays begin at a random column.
inline PointCloud Scan(const PatchWorld& world, const Rigid3d& world_from_sensor,
                       const Scanner& scanner, Random& random) {
  PointCloud cloud;
  const double first_column = random.Uniform();
  for (int ring = 0; ring < scanner.num_rings; ++ring) {
    const double share = scanner.num_rings > 1 ? ring / (scanner.num_rings - 1.0) : 0;
    const double elevation =
        scanner.lowest_rad + share * (scanner.highest_rad - scanner.lowest_rad);
    for (int column = 0; column < scanner.num_columns; ++column) {
      const double azimuth = (column + first_column) * 2 * M_PI / scanner.num_columns;
      const Eigen::Vector3d ray(std::cos(azimuth) * std::cos(elevation),
                                std::sin(azimuth) * std::cos(elevation), std::sin(elevation));
      const Eigen::Vector3d direction = world_from_sensor.rotation * ray;
      double range = std::numeric_limits<double>::infinity();
      for (const Patch& patch : world) {
        range = std::min(range, RangeTo(patch, world_from_sensor.translation, direction));
      }
      if (range > scanner.max_range_m) continue;
      range += scanner.range_sigma_m * random.Normal();
      cloud.points.push_back((range * ray).cast<float>());
    }
  }
  return cloud;
}

// A pose 1 m above the floor.
inline Rigid3d StandingAt(double x, double y, double yaw) {
  return Rigid3d(ExpSO3(Eigen::Vector3d(0, 0, yaw)), Eigen::Vector3d(x, y, 1));
}

struct ScanPair {
  PointCloud source, target;
  Rigid3d target_from_source;  // the truth
};

inline ScanPair ScanTwice(const PatchWorld& world, const Rigid3d& world_from_source,
                          const Rigid3d& world_from_target, const Scanner& scanner, uint64_t seed) {
  Random random(seed);
  ScanPair pair;
  pair.source = Scan(world, world_from_source, scanner, random);
  pair.target = Scan(world, world_from_target, scanner, random);
  pair.target_from_source = world_from_target.Inverse() * world_from_source;
  return pair;
}

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_SIMULATED_SCANS_H_
