// SPDX-License-Identifier: Apache-2.0
// Smooth ways for simulated robots.
#ifndef OVERTONE_CORE_SIMULATION_UNIFORM_SPLINE_H_
#define OVERTONE_CORE_SIMULATION_UNIFORM_SPLINE_H_

#include <vector>

#include "Eigen/Core"

namespace overtone {

struct SplinePoint {
  Eigen::Vector2d position;
  Eigen::Vector2d direction;  // derivative by u
};

// A uniform cubic B-spline in the plane: twice continuously differentiable, near its control points
// and between two of them for u from 0 to 1. At least four control points, u from 0 to their number
// less three. de Boor, A Practical Guide to Splines, 1978.
SplinePoint EvaluateSpline(const std::vector<Eigen::Vector2d>& control, double u);

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_UNIFORM_SPLINE_H_
