// SPDX-License-Identifier: Apache-2.0
// The direction in which a surface is thin: where the spread of a point's neighbours is least.
#ifndef OVERTONE_CORE_REGISTRATION_NORMAL_ESTIMATION_H_
#define OVERTONE_CORE_REGISTRATION_NORMAL_ESTIMATION_H_

#include <vector>

#include "Eigen/Core"
#include "overtone/core/registration/kd_tree.h"

namespace overtone {

enum class SurfaceKind {
  kSurface,  // 3-D points on surfaces
  kOutline,  // points of one level (z = 0) on lines: the normal lies in the level, too
};

// One unit normal for each point, of either sign, from the point and its num_neighbors - 1 nearest;
// num_neighbors >= 3. `tree` is that of `points`.
//
// In Generalized-ICP a point's covariance, regularised to be plane-like, is I - (1 - eps) n n^T
// (line-like within the level for an outline): the normal is all that it needs.
std::vector<Eigen::Vector3f> EstimateNormals(const std::vector<Eigen::Vector3f>& points,
                                             const KdTree& tree, int num_neighbors,
                                             SurfaceKind kind);

}  // namespace overtone

#endif  // OVERTONE_CORE_REGISTRATION_NORMAL_ESTIMATION_H_
