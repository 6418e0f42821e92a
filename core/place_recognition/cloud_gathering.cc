// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/place_recognition/cloud_gathering.h"

namespace overtone {

size_t GatheringStart(absl::Span<const CloudAtPose> keyframes, double length_m) {
  size_t start = keyframes.size() - 1;
  for (double way = 0; start > 0; --start) {
    way += (keyframes[start].mission_from_body.translation -
            keyframes[start - 1].mission_from_body.translation)
               .norm();
    if (way > length_m) break;
  }
  return start;
}

PointCloud GatherClouds(absl::Span<const CloudAtPose> keyframes, double length_m) {
  const Rigid3d newest_from_mission = keyframes.back().mission_from_body.Inverse();
  PointCloud gathered;
  for (const CloudAtPose& keyframe : keyframes.subspan(GatheringStart(keyframes, length_m))) {
    if (keyframe.cloud == nullptr) continue;
    const Rigid3d newest_from_body = newest_from_mission * keyframe.mission_from_body;
    const Eigen::Matrix3f rotation = newest_from_body.rotation.toRotationMatrix().cast<float>();
    const Eigen::Vector3f translation = newest_from_body.translation.cast<float>();
    for (const Eigen::Vector3f& point : keyframe.cloud->points) {
      gathered.points.push_back(rotation * point + translation);
    }
    gathered.intensities.insert(gathered.intensities.end(), keyframe.cloud->intensities.begin(),
                                keyframe.cloud->intensities.end());
  }
  if (gathered.intensities.size() != gathered.size()) gathered.intensities.clear();
  return gathered;
}

}  // namespace overtone
