// SPDX-License-Identifier: Apache-2.0
// The weighted radius graph as its Laplacian at once, without an adjacency beside it: what the
// robot builds at every revision.
#ifndef OVERTONE_CORE_SPECTRAL_RADIUS_GRAPH_H_
#define OVERTONE_CORE_SPECTRAL_RADIUS_GRAPH_H_

#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/geometry/se3.h"
#include "overtone/core/spectral/edge_weights.h"

namespace overtone {

// GraphLaplacian(RadiusGraphAdjacency(poses, options)), with its errors, up to the rounding of the
// degrees.
absl::StatusOr<SparseMatrix> RadiusGraphLaplacian(const std::vector<Rigid3d>& poses,
                                                  const RadiusGraphOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_RADIUS_GRAPH_H_
