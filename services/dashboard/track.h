// SPDX-License-Identifier: Apache-2.0
// Numbers along a mission, three for each node, as the page draws them.
#ifndef OVERTONE_SERVICES_DASHBOARD_TRACK_H_
#define OVERTONE_SERVICES_DASHBOARD_TRACK_H_

#include <cstdint>
#include <string>
#include <vector>

#include "Eigen/Core"
#include "overtone/v1/map_admin_service.pb.h"
#include "overtone/v1/report.pb.h"

namespace overtone {

// Row i belongs to keyframe index[i]; index strictly increasing.
struct Track {
  std::vector<int32_t> index;
  std::vector<float> values;  // 3 x size

  size_t size() const { return index.size(); }
};

// The optimised positions, metres, map frame less `origin`: float keeps millimetres within 10 km of
// it. Every stride-th keyframe and the last one.
Track MapPositions(const v1::GetTrajectoryResponse& trajectory, const Eigen::Vector3d& origin,
                   int stride);

// What the robot uploaded, metres, mission frame. Empty where the server sent none.
Track OdometryPositions(const v1::GetTrajectoryResponse& trajectory, int stride);

// The discrepancy in the bands small, mid and large. Empty when the columns differ in length.
Track Discrepancy(const v1::ComparisonReport& comparison);

// At most every stride-th row, and the last one.
Track Thinned(const Track& track, int stride);

// Same rows, and no value further apart than `tolerance`.
bool AreAlike(const Track& a, const Track& b, float tolerance);

}  // namespace overtone

#endif  // OVERTONE_SERVICES_DASHBOARD_TRACK_H_
