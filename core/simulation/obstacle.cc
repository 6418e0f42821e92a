// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/obstacle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

namespace overtone {
namespace {

// From when to when, along the ray, one condition holds.
struct Interval {
  double begin = -std::numeric_limits<double>::infinity();
  double end = std::numeric_limits<double>::infinity();
};

Interval Both(const Interval& a, const Interval& b) {
  return {std::max(a.begin, b.begin), std::min(a.end, b.end)};
}

constexpr Interval kNever = {1, 0};

// low <= x + t * dx <= high
Interval Between(double x, double dx, double low, double high) {
  if (dx == 0) return x >= low && x <= high ? Interval() : kNever;
  const double a = (low - x) / dx, b = (high - x) / dx;
  return {std::min(a, b), std::max(a, b)};
}

// |p + t * d| <= radius
Interval WithinCircle(const Eigen::Vector2d& p, const Eigen::Vector2d& d, double radius) {
  const double a = d.squaredNorm(), b = p.dot(d), c = p.squaredNorm() - radius * radius;
  if (a == 0) return c <= 0 ? Interval() : kNever;
  const double discriminant = b * b - a * c;
  if (discriminant < 0) return kNever;
  const double root = std::sqrt(discriminant);
  return {(-b - root) / a, (-b + root) / a};
}

Eigen::Vector2d InAxes(const Obstacle& obstacle, const Eigen::Vector2d& v) {
  const Eigen::Vector2d& x = obstacle.axis;
  return {x.dot(v), x.x() * v.y() - x.y() * v.x()};
}

}  // namespace

double CastRay(const Obstacle& obstacle, const Eigen::Vector3d& origin,
               const Eigen::Vector3d& direction) {
  const Eigen::Vector2d p = InAxes(obstacle, origin.head<2>() - obstacle.center);
  const Eigen::Vector2d d = InAxes(obstacle, direction.head<2>());
  const Eigen::Vector2d& half = obstacle.half_size;
  const Interval across = obstacle.round ? WithinCircle(p, d, half.x())
                                         : Both(Between(p.x(), d.x(), -half.x(), half.x()),
                                                Between(p.y(), d.y(), -half.y(), half.y()));
  const Interval inside =
      Both(across, Between(origin.z(), direction.z(), obstacle.bottom, obstacle.top));
  return inside.begin >= 0 && inside.begin <= inside.end ? inside.begin
                                                         : std::numeric_limits<double>::infinity();
}

// The signed distance of a prism from those of its cross section and of its height.
double DistanceToSurface(const Obstacle& obstacle, const Eigen::Vector3d& point) {
  const Eigen::Vector2d p = InAxes(obstacle, point.head<2>() - obstacle.center);
  double across;
  if (obstacle.round) {
    across = p.norm() - obstacle.half_size.x();
  } else {
    const Eigen::Vector2d q = p.cwiseAbs() - obstacle.half_size;
    across = q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0);
  }
  const double above = std::max(point.z() - obstacle.top, obstacle.bottom - point.z());
  const Eigen::Vector2d both(across, above);
  return std::abs(both.cwiseMax(0).norm() + std::min(both.maxCoeff(), 0.0));
}

}  // namespace overtone
