// SPDX-License-Identifier: Apache-2.0
// Places along one way through a simulated tunnel system, scanned by a LiDAR of 16 rings (14,400
// rays), for the benchmarks of loop detection.
#ifndef OVERTONE_BENCHMARK_SIMULATED_PLACES_H_
#define OVERTONE_BENCHMARK_SIMULATED_PLACES_H_

#include <memory>
#include <string>
#include <vector>

#include "overtone/core/geometry/se3.h"
#include "overtone/core/graph/point_cloud.h"

namespace overtone {

struct SimulatedPlace {
  Rigid3d world_from_body;
  std::shared_ptr<const PointCloud> cloud;  // as decoded from
  std::shared_ptr<const std::string> blob;
};

// The way's first `count` keyframes, 1.5 m or 0.5 rad apart, each `aside_m` to the left of it: the
// same way driven again is not the same scans. Aborts where the way is shorter.
std::vector<SimulatedPlace> SimulatePlaces(int count, double aside_m, uint64_t seed);

}  // namespace overtone

#endif  // OVERTONE_BENCHMARK_SIMULATED_PLACES_H_
