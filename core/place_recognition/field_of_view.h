// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CORE_PLACE_RECOGNITION_FIELD_OF_VIEW_H_
#define OVERTONE_CORE_PLACE_RECOGNITION_FIELD_OF_VIEW_H_

#include "overtone/core/graph/point_cloud.h"

namespace overtone {

// True when the points lie in most directions around body's z axis (four in five sectors of 6
// degrees), as a spinning sensor's do anywhere but next to wide open ground. O(points).
bool SeesAllAround(const PointCloud& cloud);

// True for a planar laser: its points all have one height in the body frame. O(points).
bool IsPlanar(const PointCloud& cloud, double thickness_m);

}  // namespace overtone

#endif  // OVERTONE_CORE_PLACE_RECOGNITION_FIELD_OF_VIEW_H_
