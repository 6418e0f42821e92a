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

struct SurfaceNormal {
  Eigen::Vector3f direction;  // unit, of either sign
  // 1 - least spread / next spread, [0, 1]: 1 on a clean surface, near 0 where the neighbours lie
  // on a line in space (a single ring of a LiDAR) or are strewn, and the direction is chance.
  float certainty = 0;
};

// For each point, from the point and its num_neighbors - 1 nearest;
// num_neighbors >= 3. `tree` is that of `points`.
//
// In Generalized-ICP a point's covariance, regularised to be plane-like, is I - (1 - eps) n n^T
// (line-like within the level for an outline): the normal is all that it needs.
std::vector<SurfaceNormal> EstimateNormals(const std::vector<Eigen::Vector3f>& points,
                                           const KdTree& tree, int num_neighbors, SurfaceKind kind);

}  // namespace overtone

#endif  // OVERTONE_CORE_REGISTRATION_NORMAL_ESTIMATION_H_
