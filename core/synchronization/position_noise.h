// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CORE_SYNCHRONIZATION_POSITION_NOISE_H_
#define OVERTONE_CORE_SYNCHRONIZATION_POSITION_NOISE_H_

#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

// Metres by which positions of server and robot would be apart, root mean square, if all that
// divides them were noise of single nodes: from the second differences of positions, each seen from
// its middle pose, so that neither the two frames nor smooth drift counts; robust, by their median.
// What is far above it is drift, in whatever direction (von Neumann, Annals of Mathematical
// Statistics 12(4), 1941). 0 for fewer than three nodes.
double PositionNoise(const TrajectoryComparison& comparison);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_POSITION_NOISE_H_
