// SPDX-License-Identifier: Apache-2.0
// A world of surfaces that rays hit: ground, walls, ceilings and obstacles of a floor plan, in a
// uniform grid. Immutable once made, so any number of threads may read it.
#ifndef OVERTONE_CORE_SIMULATION_WORLD_H_
#define OVERTONE_CORE_SIMULATION_WORLD_H_

#include <cstdint>
#include <vector>

#include "Eigen/Core"
#include "Eigen/Geometry"
#include "overtone/core/simulation/contour.h"
#include "overtone/core/simulation/floor_plan.h"

namespace overtone {

// Frame: world, metres, z up. Ground and ceiling are bilinear between the corners of the cells,
// walls are upright and straight within one; what is thinner than a cell may vanish.
class World {
 public:
  static constexpr double kCellM = 0.5;

  explicit World(const FloorPlan& plan);

  // From `origin`, which must lie in the open, along `direction` (unit) to the first surface;
  // infinity when there is none within max_range_m, or only sky. Walks the cells under the ray:
  // Amanatides & Woo, Eurographics 1987.
  double CastRay(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                 double max_range_m) const;

  // z of the ground; `position` within bounds().
  double GroundHeight(const Eigen::Vector2d& position) const;

  // From `point` to the nearest surface within limit_m, else limit_m. To ground and ceiling it is
  // the vertical distance. `point` within bounds().
  double DistanceToSurface(const Eigen::Vector3d& point, double limit_m) const;

  const Eigen::AlignedBox2d& bounds() const { return bounds_; }
  const std::vector<Segment>& walls() const { return walls_; }
  const std::vector<Obstacle>& obstacles() const { return obstacles_; }

 private:
  struct Cell {
    float highest_ground;   // above every ceiling where the cell is solid
    float lowest_ceiling;   // a ray between the two meets neither
    uint32_t first_wall;    // in walls_; the next cell's is this one's end
    uint32_t first_object;  // in objects_, likewise
  };
  // One ray, and its piece in one cell.
  struct Ray {
    const Eigen::Vector3d& origin;
    const Eigen::Vector3d& direction;
    double begin, end;
  };

  int CellIndex(const Eigen::Vector2i& cell) const { return cell.y() * size_.x() + cell.x(); }
  bool Contains(const Eigen::Vector2i& cell) const {
    return cell.x() >= 0 && cell.y() >= 0 && cell.x() < size_.x() && cell.y() < size_.y();
  }
  Eigen::Vector2i CellAt(const Eigen::Vector2d& position) const;
  void AddCell(const Eigen::Vector2i& cell, const std::vector<double>& wall_distance);
  void AddObstacles(const std::vector<Obstacle>& obstacles);
  double CastInCell(const Eigen::Vector2i& cell, const Ray& ray) const;
  double CastToSheet(const std::vector<float>& heights, double side, const Eigen::Vector2i& cell,
                     const Ray& ray) const;
  double HeightAt(const std::vector<float>& heights, const Eigen::Vector2d& position) const;

  Eigen::AlignedBox2d bounds_;
  Eigen::Vector2i size_;  // cells
  double sky_;
  std::vector<float> ground_, ceiling_;  // at the cells' corners, size_ + 1 of them each way
  std::vector<Cell> cells_;              // and one more, which ends the last
  std::vector<Segment> walls_;
  std::vector<uint32_t> objects_;  // positions in obstacles_, once for each cell they touch
  std::vector<Obstacle> obstacles_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_WORLD_H_
