// SPDX-License-Identifier: Apache-2.0
// What a robot saw over the last metres of its way, as if at once. From one keyframe a planar laser
// sees too little: with 5 m of way it recognises a fifth more of the places it comes within 1 m of
// (public_places_test). The 3-D lidar there, though it sees 70 degrees only, needs no more than 1
// m.
#ifndef OVERTONE_CORE_PLACE_RECOGNITION_CLOUD_GATHERING_H_
#define OVERTONE_CORE_PLACE_RECOGNITION_CLOUD_GATHERING_H_

#include <memory>

#include "absl/types/span.h"
#include "overtone/core/geometry/se3.h"
#include "overtone/core/graph/point_cloud.h"

namespace overtone {

struct CloudAtPose {
  Rigid3d mission_from_body;                // odometry
  std::shared_ptr<const PointCloud> cloud;  // null: this keyframe has none
};

// The first of `keyframes` (consecutive, of one mission, not empty) from which the way to the last
// is no longer than `length_m`. Two gatherings that share a keyframe are alike for that alone.
size_t GatheringStart(absl::Span<const CloudAtPose> keyframes, double length_m);

// The points of the keyframes from there on, in the body frame of the last. Intensities when all
// have them. Not thinned.
PointCloud GatherClouds(absl::Span<const CloudAtPose> keyframes, double length_m);

}  // namespace overtone

#endif  // OVERTONE_CORE_PLACE_RECOGNITION_CLOUD_GATHERING_H_
