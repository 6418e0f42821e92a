// SPDX-License-Identifier: Apache-2.0
// Where a world is open: spaces carved out of solid rock, and what stands in them. A robot may go
// where its tunnels, rooms and fields overlap, so a network of them is navigable by construction.
#ifndef OVERTONE_CORE_SIMULATION_FLOOR_PLAN_H_
#define OVERTONE_CORE_SIMULATION_FLOOR_PLAN_H_

#include <cstdint>
#include <vector>

#include "Eigen/Core"
#include "overtone/core/simulation/obstacle.h"

namespace overtone {

// A rectangle with rounded corners, seen from above: a room (radius 0), a hall (half_size 0), or,
// with half_size.y() = 0, a tunnel. World frame, metres.
struct Space {
  Eigen::Vector2d center = Eigen::Vector2d::Zero();
  Eigen::Vector2d axis = Eigen::Vector2d::UnitX();  // unit; along half_size.x()
  Eigen::Vector2d half_size = Eigen::Vector2d::Zero();
  double radius = 0;     // added all around
  double height = 3;     // of the ceiling above the ground
  double roughness = 0;  // of walls and ceiling: the most they are displaced by
  double relief = 0;     // of the ground: the most it rises or falls

  // Signed distance in the plane, negative inside; walls not yet displaced.
  double Distance(const Eigen::Vector2d& position) const;
};

// An open sky is a height above FloorPlan::sky.
inline constexpr double kOpenSky = 1000;

struct FloorPlan {
  std::vector<Space> spaces;
  std::vector<Obstacle> obstacles;
  double sky = 30;    // nothing is higher; rays that rise to it return nothing
  uint64_t seed = 0;  // of the irregularities

  // The world at one position.
  struct Column {
    double wall;     // signed distance to the nearest wall (approximately, where rough), < 0: open
    double ground;   // z
    double ceiling;  // z
  };
  Column At(const Eigen::Vector2d& position) const;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_FLOOR_PLAN_H_
