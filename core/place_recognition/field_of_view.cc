// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/place_recognition/field_of_view.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <limits>

namespace overtone {

bool SeesAllAround(const PointCloud& cloud) {
  constexpr int kSectors = 60;
  constexpr size_t kEnough = 48;
  std::bitset<kSectors> seen;
  for (const Eigen::Vector3f& point : cloud.points) {
    const double turns = std::atan2(point.y(), point.x()) / (2 * M_PI) + 0.5;  // [0, 1]
    seen.set(std::min(static_cast<int>(turns * kSectors), kSectors - 1));
  }
  return seen.count() >= kEnough;
}

bool IsPlanar(const PointCloud& cloud, double thickness_m) {
  float lowest = std::numeric_limits<float>::infinity(), highest = -lowest;
  for (const Eigen::Vector3f& point : cloud.points) {
    lowest = std::min(lowest, point.z());
    highest = std::max(highest, point.z());
  }
  return highest - lowest <= thickness_m;
}

}  // namespace overtone
