// SPDX-License-Identifier: Apache-2.0
// Smooth irregularity for walls, ceilings and ground. Only sums and products: the same numbers on
// every platform.
#ifndef OVERTONE_CORE_SIMULATION_VALUE_NOISE_H_
#define OVERTONE_CORE_SIMULATION_VALUE_NOISE_H_

#include <cstdint>

#include "Eigen/Core"

namespace overtone {

// In [-1, 1]: independent uniform values at the points with integer coordinates, blended between
// them with zero slope at each. Continuous, and with it its gradient. Perlin, SIGGRAPH 1985.
double ValueNoise(uint64_t seed, const Eigen::Vector2d& position);

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_VALUE_NOISE_H_
