// SPDX-License-Identifier: Apache-2.0
// Poses and landmarks tied by relative measurements: what the optimiser solves. g2o files hold the
// poses and edges.
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

// A point seen from a pose: a landmark of the graph, or a point fixed in the frame of another pose
// (a tag on another robot).
struct PointSighting {
  int pose = 0;          // observer, position in PoseGraph::poses
  int landmark = -1;     // position in PoseGraph::landmarks, or -1 for:
  int target_pose = -1;  // another pose,
  Eigen::Vector3d point_in_target = Eigen::Vector3d::Zero();  // and the point in its frame
  Eigen::Vector3d point_in_pose = Eigen::Vector3d::Zero();    // as measured
  // Inverse covariance of point_in_pose, in the observer's axes.
  Eigen::Matrix3d information = Eigen::Matrix3d::Identity();
};

struct PoseGraph {
  std::vector<Rigid3d> poses;  // world_from_body
  std::vector<PoseGraphEdge> edges;
  std::vector<Eigen::Vector3d> landmarks;  // in world
  std::vector<PointSighting> sightings;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_GRAPH_POSE_GRAPH_H_
