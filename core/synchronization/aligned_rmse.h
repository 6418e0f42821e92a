// SPDX-License-Identifier: Apache-2.0
#ifndef OVERTONE_CORE_SYNCHRONIZATION_ALIGNED_RMSE_H_
#define OVERTONE_CORE_SYNCHRONIZATION_ALIGNED_RMSE_H_

#include <vector>

#include "overtone/core/geometry/se3.h"

namespace overtone {

// How far two estimates of the same poses are apart, whatever their frames: RMSE of positions after
// the best rigid motion. Defined for all finite poses: where all lie on one line, their centroids
// and the directions from first to last are aligned. Same length; 0 for none.
double AlignedRmse(const std::vector<Rigid3d>& estimate, const std::vector<Rigid3d>& reference);
// Of the positions alone.
double AlignedRmse(const std::vector<Eigen::Vector3d>& estimate,
                   const std::vector<Eigen::Vector3d>& reference);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_ALIGNED_RMSE_H_
