// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/track.h"

#include <algorithm>
#include <cmath>

namespace overtone {
namespace {

void Append(int64_t index, const Eigen::Vector3d& point, Track& track) {
  track.index.push_back(static_cast<int32_t>(index));
  for (int i = 0; i < 3; ++i) track.values.push_back(static_cast<float>(point[i]));
}

Eigen::Vector3d Position(const v1::Pose& pose) {
  return {pose.position().x(), pose.position().y(), pose.position().z()};
}

// Calls `take` with 0, stride, 2 stride, ... and size - 1.
template <typename Take>
void ForEachKept(int size, int stride, Take take) {
  for (int i = 0; i < size; i += std::max(1, stride)) take(i);
  if (size > 0 && (size - 1) % std::max(1, stride) != 0) take(size - 1);
}

}  // namespace

Track MapPositions(const v1::GetTrajectoryResponse& trajectory, const Eigen::Vector3d& origin,
                   int stride) {
  Track track;
  ForEachKept(trajectory.nodes_size(), stride, [&](int i) {
    const v1::Node& node = trajectory.nodes(i);
    Append(node.index(), Position(node.map_tform_body()) - origin, track);
  });
  return track;
}

Track OdometryPositions(const v1::GetTrajectoryResponse& trajectory, int stride) {
  Track track;
  if (trajectory.odometry_size() != trajectory.nodes_size()) return track;
  ForEachKept(trajectory.nodes_size(), stride, [&](int i) {
    Append(trajectory.nodes(i).index(), Position(trajectory.odometry(i)), track);
  });
  return track;
}

Track Discrepancy(const v1::ComparisonReport& comparison) {
  Track track;
  const int size = comparison.index_size();
  if (comparison.small_size() != size || comparison.mid_size() != size ||
      comparison.large_size() != size) {
    return track;
  }
  for (int i = 0; i < size; ++i) {
    Append(comparison.index(i), {comparison.small(i), comparison.mid(i), comparison.large(i)},
           track);
  }
  return track;
}

Track Thinned(const Track& track, int stride) {
  Track thinned;
  ForEachKept(static_cast<int>(track.size()), stride, [&](int i) {
    thinned.index.push_back(track.index[i]);
    thinned.values.insert(thinned.values.end(), track.values.begin() + 3 * i,
                          track.values.begin() + 3 * i + 3);
  });
  return thinned;
}

bool AreAlike(const Track& a, const Track& b, float tolerance) {
  return a.index == b.index &&
         std::equal(a.values.begin(), a.values.end(), b.values.begin(), b.values.end(),
                    [tolerance](float x, float y) { return std::abs(x - y) <= tolerance; });
}

}  // namespace overtone
