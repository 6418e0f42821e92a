// SPDX-License-Identifier: Apache-2.0
// Poses over time: interpolation, association by stamp, length.
#ifndef OVERTONE_CORE_GEOMETRY_TRAJECTORY_H_
#define OVERTONE_CORE_GEOMETRY_TRAJECTORY_H_

#include <utility>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/common/timestamp.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

struct StampedPose {
  Timestamp stamp;
  Rigid3d pose;  // world_from_body
};

// Stamps strictly increasing.
using Trajectory = std::vector<StampedPose>;

std::vector<Timestamp> Stamps(const Trajectory& trajectory);
std::vector<Rigid3d> Poses(const Trajectory& trajectory);

// The pose at `stamp`: constant linear and angular velocity between the two poses around it. O(log
// n). OutOfRange: before the first or after the last pose, or there is none. Never extrapolates.
absl::StatusOr<Rigid3d> Interpolate(const Trajectory& trajectory, Timestamp stamp);

// Pairs (position in a, position in b) of stamps at most tolerance_s apart, each used at most once,
// the closest pair first served; sorted by the position in a. The stamps may come in any order. O(n
// log n) whatever the tolerance. Empty for a negative or NaN tolerance.
std::vector<std::pair<int, int>> AssociateByTime(const std::vector<Timestamp>& a,
                                                 const std::vector<Timestamp>& b,
                                                 double tolerance_s);

// Sum of the distances between successive positions, metres.
double PathLength(const Trajectory& trajectory);
double PathLength(const std::vector<Rigid3d>& poses);

}  // namespace overtone

#endif  // OVERTONE_CORE_GEOMETRY_TRAJECTORY_H_
