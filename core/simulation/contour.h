// SPDX-License-Identifier: Apache-2.0
// Marching squares: where a function known at the corners of a square changes its sign.
#ifndef OVERTONE_CORE_SIMULATION_CONTOUR_H_
#define OVERTONE_CORE_SIMULATION_CONTOUR_H_

#include <array>
#include <vector>

#include "Eigen/Core"

namespace overtone {

struct Segment {
  Eigen::Vector2d begin;
  Eigen::Vector2d end;
};

// Appends the zero line inside the unit square: up to two segments, ends on the square's edges,
// linear in between, so that neighbouring squares meet and a straight line stays straight. values:
// at (0, 0), (1, 0), (1, 1), (0, 1); zero counts as positive. Lorensen & Cline, SIGGRAPH 1987, in
// two dimensions; a saddle is cut so that its negative corners stay apart.
void AppendContour(const std::array<double, 4>& values, std::vector<Segment>* segments);

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_CONTOUR_H_
