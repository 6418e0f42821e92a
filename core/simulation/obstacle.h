// SPDX-License-Identifier: Apache-2.0
// Things that stand about: pillars, crates, rubble.
#ifndef OVERTONE_CORE_SIMULATION_OBSTACLE_H_
#define OVERTONE_CORE_SIMULATION_OBSTACLE_H_

#include "Eigen/Core"

namespace overtone {

// An upright box or cylinder. World frame, metres, z up.
struct Obstacle {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  Eigen::Vector2d axis = Eigen::Vector2d::UnitX();      // unit; along half_size.x()
  Eigen::Vector2d half_size = Eigen::Vector2d::Zero();  // positive; a cylinder: x() is its radius
  bool round = false;
  double bottom = 0;
  double top = 0;  // above bottom

  // Of a circle around `center` that contains it.
  double Radius() const { return round ? half_size.x() : half_size.norm(); }
};

// Distance along the ray to where it enters, infinity when it does not. `direction` is of unit
// length; a ray from inside enters nowhere.
double CastRay(const Obstacle& obstacle, const Eigen::Vector3d& origin,
               const Eigen::Vector3d& direction);

// From `point` to the nearest point of the obstacle's surface, 0 or more, also from inside.
double DistanceToSurface(const Obstacle& obstacle, const Eigen::Vector3d& point);

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_OBSTACLE_H_
