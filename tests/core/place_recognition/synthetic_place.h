// SPDX-License-Identifier: Apache-2.0
// A place without design: poles all around, of random distance and height. Some places are wide,
// some narrow.
#ifndef OVERTONE_TESTS_CORE_PLACE_RECOGNITION_SYNTHETIC_PLACE_H_
#define OVERTONE_TESTS_CORE_PLACE_RECOGNITION_SYNTHETIC_PLACE_H_

#include <cmath>
#include <random>

#include "Eigen/Geometry"
#include "overtone/core/graph/point_cloud.h"

namespace overtone {

// Between the headings `first_rad` and `last_rad`; the same seed gives the same things there,
// however much of the circle is seen.
inline PointCloud SyntheticPlace(unsigned seed, double first_rad = -M_PI, double last_rad = M_PI,
                                 int things = 240) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> unit(0, 1);
  const double width = 4 + 26 * unit(random);
  PointCloud cloud;
  for (int i = 0; i < things; ++i) {
    const double heading = -M_PI + 2 * M_PI * (i + 0.5) / things;
    const double range = 2 * std::pow(width, unit(random));
    const double height = 8 * unit(random);
    if (heading < first_rad || heading > last_rad) continue;
    const Eigen::Vector2f foot(range * std::cos(heading), range * std::sin(heading));
    for (const double z : {-1.0, -1.0 + height}) cloud.points.emplace_back(foot.x(), foot.y(), z);
  }
  return cloud;
}

inline PointCloud Turned(PointCloud cloud, const Eigen::Quaterniond& rotation) {
  for (Eigen::Vector3f& point : cloud.points) point = rotation.cast<float>() * point;
  return cloud;
}

inline Eigen::Quaterniond Yaw(double yaw_rad) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ()));
}

}  // namespace overtone

#endif  // OVERTONE_TESTS_CORE_PLACE_RECOGNITION_SYNTHETIC_PLACE_H_
