// SPDX-License-Identifier: Apache-2.0
// Points as a range sensor saw them: one scan, or several gathered around one keyframe.
#ifndef OVERTONE_CORE_GRAPH_POINT_CLOUD_H_
#define OVERTONE_CORE_GRAPH_POINT_CLOUD_H_

#include <cstdint>
#include <vector>

#include "Eigen/Core"

namespace overtone {

struct PointCloud {
  std::vector<Eigen::Vector3f> points;  // metres, in the body frame of its keyframe; finite
  std::vector<uint8_t> intensities;     // empty, or one for each point; the sensor's own scale

  size_t size() const { return points.size(); }
  bool empty() const { return points.empty(); }
};

}  // namespace overtone

#endif  // OVERTONE_CORE_GRAPH_POINT_CLOUD_H_
