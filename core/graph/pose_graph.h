// SPDX-License-Identifier: Apache-2.0
// Poses tied by relative measurements: what the optimiser solves and g2o files hold.
#ifndef OVERTONE_CORE_GRAPH_POSE_GRAPH_H_
#define OVERTONE_CORE_GRAPH_POSE_GRAPH_H_

#include <vector>

#include "overtone/core/geometry/se3.h"

namespace overtone {

enum class EdgeKind { kOdometry, kLoopClosure };

struct PoseGraphEdge {
  int from = 0;  // positions in PoseGraph::poses
  int to = 0;
  Rigid3d from_tform_to;
  Matrix6d information =
      Matrix6d::Identity();  // inverse covariance, right tangent of from_tform_to
  EdgeKind kind = EdgeKind::kOdometry;
};

struct PoseGraph {
  std::vector<Rigid3d> poses;  // world_from_body
  std::vector<PoseGraphEdge> edges;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_GRAPH_POSE_GRAPH_H_
