// SPDX-License-Identifier: Apache-2.0
// How a world is built, and what is asked of it at a point. Rays: world_ray.cc.
#include "overtone/core/simulation/world.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace overtone {
namespace {

constexpr double kMarginM = 2;  // of solid rock around the outermost spaces

Eigen::AlignedBox2d BoundsOf(const FloorPlan& plan) {
  Eigen::AlignedBox2d bounds;
  for (const Space& space : plan.spaces) {
    const double reach = space.radius + space.roughness + kMarginM;
    const Eigen::Vector2d x = space.axis.cwiseAbs();
    const Eigen::Vector2d extent = space.half_size.x() * x + space.half_size.y() * x.reverse() +
                                   Eigen::Vector2d::Constant(reach);
    bounds.extend(space.center - extent);
    bounds.extend(space.center + extent);
  }
  return bounds;
}

double Distance(const Segment& segment, const Eigen::Vector2d& point) {
  const Eigen::Vector2d along = segment.end - segment.begin, to_point = point - segment.begin;
  const double length2 = along.squaredNorm();
  const double t = length2 > 0 ? std::clamp(to_point.dot(along) / length2, 0.0, 1.0) : 0;
  return (to_point - t * along).norm();
}

}  // namespace

World::World(const FloorPlan& plan) : sky_(plan.sky) {
  const Eigen::AlignedBox2d wanted = BoundsOf(plan);
  // On multiples of the cell's size: walls that are, too, are met exactly.
  const Eigen::Vector2d low = (wanted.min() / kCellM).array().floor();
  const Eigen::Vector2d high = (wanted.max() / kCellM).array().ceil();
  bounds_ = Eigen::AlignedBox2d(low * kCellM, high * kCellM);
  size_ = (high - low).cast<int>();

  std::vector<double> wall_distance;
  for (int y = 0; y <= size_.y(); ++y) {
    for (int x = 0; x <= size_.x(); ++x) {
      const FloorPlan::Column column = plan.At(bounds_.min() + kCellM * Eigen::Vector2d(x, y));
      wall_distance.push_back(column.wall);
      ground_.push_back(static_cast<float>(column.ground));
      ceiling_.push_back(static_cast<float>(column.ceiling));
    }
  }
  for (int y = 0; y < size_.y(); ++y) {
    for (int x = 0; x < size_.x(); ++x) AddCell({x, y}, wall_distance);
  }
  cells_.push_back({0, 0, static_cast<uint32_t>(walls_.size()), 0});
  AddObstacles(plan.obstacles);
}

void World::AddCell(const Eigen::Vector2i& cell, const std::vector<double>& wall_distance) {
  const int row = size_.x() + 1, corner = cell.y() * row + cell.x();
  const std::array<int, 4> corners = {corner, corner + 1, corner + row + 1, corner + row};
  Cell added = {-std::numeric_limits<float>::infinity(), std::numeric_limits<float>::infinity(),
                static_cast<uint32_t>(walls_.size()), 0};
  std::array<double, 4> distance;
  for (int i = 0; i < 4; ++i) {
    distance[i] = wall_distance[corners[i]];
    added.highest_ground = std::max(added.highest_ground, ground_[corners[i]]);
    added.lowest_ceiling = std::min(added.lowest_ceiling, ceiling_[corners[i]]);
  }
  if (*std::min_element(distance.begin(), distance.end()) >= 0) {
    added.highest_ground = std::numeric_limits<float>::infinity();
  }
  AppendContour(distance, &walls_);
  const Eigen::Vector2d origin = bounds_.min() + kCellM * cell.cast<double>();
  for (size_t i = added.first_wall; i < walls_.size(); ++i) {
    walls_[i] = {origin + kCellM * walls_[i].begin, origin + kCellM * walls_[i].end};
  }
  cells_.push_back(added);
}

void World::AddObstacles(const std::vector<Obstacle>& obstacles) {
  obstacles_ = obstacles;
  std::vector<std::vector<uint32_t>> objects_of_cell(cells_.size());
  for (uint32_t i = 0; i < obstacles.size(); ++i) {
    const Eigen::Vector2d reach = Eigen::Vector2d::Constant(obstacles[i].Radius());
    const Eigen::Vector2i low = CellAt(obstacles[i].center - reach);
    const Eigen::Vector2i high = CellAt(obstacles[i].center + reach);
    for (int y = low.y(); y <= high.y(); ++y) {
      for (int x = low.x(); x <= high.x(); ++x) objects_of_cell[CellIndex({x, y})].push_back(i);
    }
  }
  for (size_t k = 0; k < cells_.size(); ++k) {
    cells_[k].first_object = static_cast<uint32_t>(objects_.size());
    objects_.insert(objects_.end(), objects_of_cell[k].begin(), objects_of_cell[k].end());
  }
}

// The nearest cell of the grid for positions outside it.
Eigen::Vector2i World::CellAt(const Eigen::Vector2d& position) const {
  const Eigen::Vector2d cell = ((position - bounds_.min()) / kCellM).array().floor();
  return cell.cwiseMax(0).cwiseMin((size_ - Eigen::Vector2i::Ones()).cast<double>()).cast<int>();
}

double World::HeightAt(const std::vector<float>& heights, const Eigen::Vector2d& position) const {
  const Eigen::Vector2i cell = CellAt(position);
  const Eigen::Vector2d uv = (position - bounds_.min()) / kCellM - cell.cast<double>();
  const int row = size_.x() + 1, corner = cell.y() * row + cell.x();
  const double near = heights[corner] + uv.x() * (heights[corner + 1] - heights[corner]);
  const double far =
      heights[corner + row] + uv.x() * (heights[corner + row + 1] - heights[corner + row]);
  return near + uv.y() * (far - near);
}

double World::GroundHeight(const Eigen::Vector2d& position) const {
  return HeightAt(ground_, position);
}

double World::DistanceToSurface(const Eigen::Vector3d& point, double limit_m) const {
  const Eigen::Vector2d position = point.head<2>();
  double nearest = std::min({limit_m, std::abs(point.z() - HeightAt(ground_, position)),
                             std::abs(point.z() - HeightAt(ceiling_, position))});
  const Eigen::Vector2i low = CellAt(position - Eigen::Vector2d::Constant(nearest));
  const Eigen::Vector2i high = CellAt(position + Eigen::Vector2d::Constant(nearest));
  for (int y = low.y(); y <= high.y(); ++y) {
    for (int x = low.x(); x <= high.x(); ++x) {
      const int cell = CellIndex({x, y});
      for (uint32_t i = cells_[cell].first_wall; i < cells_[cell + 1].first_wall; ++i) {
        nearest = std::min(nearest, Distance(walls_[i], position));
      }
      for (uint32_t i = cells_[cell].first_object; i < cells_[cell + 1].first_object; ++i) {
        nearest = std::min(nearest, overtone::DistanceToSurface(obstacles_[objects_[i]], point));
      }
    }
  }
  return nearest;
}

}  // namespace overtone
