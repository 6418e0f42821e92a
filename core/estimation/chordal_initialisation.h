// SPDX-License-Identifier: Apache-2.0
// First guess of a pose graph by two linear least-squares problems, good even where odometry has
// drifted far.
//   rotations:     min sum kappa |R_j - R_i Z_R|_F^2 over 3 x 3 matrices, each then moved to the
//   nearest rotation translations:  min sum tau |t_j - t_i - R_i z_t|^2 with those rotations
// Martinec & Pajdla, CVPR 2007; Carlone et al., "Initialization Techniques for 3D SLAM", ICRA 2015.
// kappa and tau are the mean rotation and translation information of the edge.
#ifndef OVERTONE_CORE_ESTIMATION_CHORDAL_INITIALISATION_H_
#define OVERTONE_CORE_ESTIMATION_CHORDAL_INITIALISATION_H_

#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/graph/pose_graph.h"

namespace overtone {

// The first pose of every component stays as given. All edges count, loop closures too: outliers
// are not rejected. Edges must be within range. FailedPrecondition: some pose is tied by edges
// without rotation or translation information only.
absl::StatusOr<std::vector<Rigid3d>> ChordalInitialisation(const PoseGraph& graph);

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_CHORDAL_INITIALISATION_H_
