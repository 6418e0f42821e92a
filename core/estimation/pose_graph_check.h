// SPDX-License-Identifier: Apache-2.0
// What the optimiser asks of a graph before it touches it.
#ifndef OVERTONE_CORE_ESTIMATION_POSE_GRAPH_CHECK_H_
#define OVERTONE_CORE_ESTIMATION_POSE_GRAPH_CHECK_H_

#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/graph/pose_graph.h"

namespace overtone {

// One factor for each edge and each sighting (square_root_information.h).
struct PoseGraphFactors {
  std::vector<Matrix6d> edges;
  std::vector<Eigen::Matrix3d> sightings;
};

// InvalidArgument, naming the pose, landmark, edge or sighting: not finite or beyond 1e15 m,
// quaternion not of unit length, index out of range, both ends the same, a sighting of neither or
// of both a landmark and a pose, information beyond 1e30 or not symmetric positive semi-definite.
absl::Status CheckPoseGraph(const PoseGraph& graph);

// The same checks; the factors come out of the last one.
absl::StatusOr<PoseGraphFactors> CheckAndFactorise(const PoseGraph& graph);

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_POSE_GRAPH_CHECK_H_
