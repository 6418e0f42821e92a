// SPDX-License-Identifier: Apache-2.0
// A small world for simulated robots: a square grid of streets on rolling ground.
#ifndef OVERTONE_CORE_SIMULATION_CAMPUS_H_
#define OVERTONE_CORE_SIMULATION_CAMPUS_H_

#include <vector>

#include "Eigen/Core"
#include "overtone/core/geometry/se3.h"
#include "overtone/core/simulation/random.h"

namespace overtone {

// Junctions at (column, row) * kBlockM, x and y in metres; z follows from the ground.
class Campus {
 public:
  static constexpr int kJunctionsPerSide = 4;
  static constexpr double kBlockM = 15;

  // Height of the ground above z = 0 and its gradient (slopes up to about 10 degrees).
  static double Height(const Eigen::Vector2d& position);
  static Eigen::Vector2d Slope(const Eigen::Vector2d& position);

  // Stands on the ground at `position`: x along the horizontal `heading` (not zero), z along the
  // ground's normal. map_from_body.
  static Rigid3d PoseOnGround(const Eigen::Vector2d& position, const Eigen::Vector2d& heading);

  // A walk over `num_streets` streets from a random junction; never turns back on the spot.
  // num_streets * kPointsPerStreet + 1 positions, evenly spaced along the streets.
  static constexpr int kPointsPerStreet = 5;
  static std::vector<Eigen::Vector2d> RandomWalk(int num_streets, Random& random);
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_CAMPUS_H_
