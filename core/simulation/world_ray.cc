// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <limits>

#include "overtone/core/simulation/world.h"

namespace overtone {
namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();
// A ray that passes where two cells meet is looked for this far into both, relative to the way so
// far, lest rounding let it slip through between their walls.
constexpr double kSeam = 1e-9;

// The smallest root of a t^2 + b t + c in (0, limit], c > 0; none: infinity.
double FirstRoot(double a, double b, double c, double limit) {
  const double discriminant = b * b - 4 * a * c;
  if (discriminant < 0) return kNone;
  // Without cancellation; a quotient by zero is infinite or NaN, and both fail the comparison.
  const double q = -0.5 * (b + std::copysign(std::sqrt(discriminant), b));
  double first = kNone;
  for (const double root : {q / a, c / q}) {
    if (root > 0 && root <= limit) first = std::min(first, root);
  }
  return first;
}

// Where the ray from `p` along `d`, seen from above, crosses the line through the wall; not finite
// when they are parallel. A wall spans its cell from edge to edge: within the cell, line and wall
// are one.
double CastToWall(const Segment& wall, const Eigen::Vector2d& p, const Eigen::Vector2d& d) {
  const Eigen::Vector2d along = wall.end - wall.begin, to_wall = wall.begin - p;
  return (to_wall.x() * along.y() - to_wall.y() * along.x()) /
         (d.x() * along.y() - d.y() * along.x());
}

}  // namespace

double World::CastRay(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                      double max_range_m) const {
  const double limit =
      direction.z() > 0 ? std::min(max_range_m, (sky_ - origin.z()) / direction.z()) : max_range_m;
  const Eigen::Vector2d start = (origin.head<2>() - bounds_.min()) / kCellM;
  Eigen::Vector2i cell = start.array().floor().cast<int>();
  if (!Contains(cell)) return kNone;
  int step[2];
  double next[2], delta[2];  // distance along the ray to the cell's end; across one cell
  for (int i = 0; i < 2; ++i) {
    const double d = direction[i];
    step[i] = d > 0 ? 1 : -1;
    delta[i] = d == 0 ? kNone : kCellM / std::abs(d);
    next[i] = d == 0 ? kNone : (cell[i] + (d > 0) - start[i]) * (kCellM / d);
  }
  Ray ray = {origin, direction, 0, 0};
  double z = origin.z();
  while (true) {
    const int across = next[0] < next[1] ? 0 : 1;
    ray.end = std::min(next[across], limit);
    const double z_end = origin.z() + ray.end * direction.z();
    const int index = CellIndex(cell);
    const Cell& here = cells_[index];
    const Cell& after = cells_[index + 1];
    const bool empty =
        std::min(z, z_end) > here.highest_ground && std::max(z, z_end) < here.lowest_ceiling &&
        here.first_wall == after.first_wall && here.first_object == after.first_object;
    if (!empty) {
      const double hit = CastInCell(cell, ray);
      if (hit <= limit) return hit;
    }
    if (ray.end >= limit) return kNone;
    cell[across] += step[across];
    if (cell[across] < 0 || cell[across] >= size_[across]) return kNone;
    ray.begin = next[across];
    next[across] += delta[across];
    z = z_end;
  }
}

double World::CastInCell(const Eigen::Vector2i& cell, const Ray& ray) const {
  const int index = CellIndex(cell);
  const Cell& here = cells_[index];
  if (here.highest_ground == kNone) return ray.begin;  // solid
  const double z_begin = ray.origin.z() + ray.begin * ray.direction.z();
  const double z_end = ray.origin.z() + ray.end * ray.direction.z();
  double hit = kNone;
  if (std::min(z_begin, z_end) <= here.highest_ground) hit = CastToSheet(ground_, 1, cell, ray);
  if (std::max(z_begin, z_end) >= here.lowest_ceiling) {
    hit = std::min(hit, CastToSheet(ceiling_, -1, cell, ray));
  }
  // Walls and obstacles reach into other cells: what lies behind this one may lie behind another
  // hit.
  const double seam = kSeam * (1 + ray.end);
  const double end = ray.end + seam;
  for (uint32_t i = here.first_wall; i < cells_[index + 1].first_wall; ++i) {
    const double t = CastToWall(walls_[i], ray.origin.head<2>(), ray.direction.head<2>());
    if (t >= ray.begin - seam && t <= end) hit = std::min(hit, t);
  }
  for (uint32_t i = here.first_object; i < cells_[index + 1].first_object; ++i) {
    const double t = overtone::CastRay(obstacles_[objects_[i]], ray.origin, ray.direction);
    if (t <= end) hit = std::min(hit, t);
  }
  return hit;
}

// `side` is 1 for the ground, which the ray is above, -1 for the ceiling. The height over the cell
// is bilinear, so the gap between ray and sheet is quadratic along the ray.
double World::CastToSheet(const std::vector<float>& heights, double side,
                          const Eigen::Vector2i& cell, const Ray& ray) const {
  const int row = size_.x() + 1, corner = cell.y() * row + cell.x();
  const double h = heights[corner];
  const double hu = heights[corner + 1] - h, hv = heights[corner + row] - h;
  const double huv = heights[corner + row + 1] - h - hu - hv;
  const Eigen::Vector2d d = ray.direction.head<2>() / kCellM;
  const Eigen::Vector2d uv =
      (ray.origin.head<2>() - bounds_.min()) / kCellM - cell.cast<double>() + ray.begin * d;
  const double gap = side * (ray.origin.z() + ray.begin * ray.direction.z() - h - hu * uv.x() -
                             hv * uv.y() - huv * uv.x() * uv.y());
  if (gap <= 0) return ray.begin;  // hit on the seam to the cell before
  const double slope = side * (ray.direction.z() - hu * d.x() - hv * d.y() -
                               huv * (uv.x() * d.y() + uv.y() * d.x()));
  const double curvature = -side * huv * d.x() * d.y();
  return ray.begin + FirstRoot(curvature, slope, gap, ray.end - ray.begin);
}

}  // namespace overtone
