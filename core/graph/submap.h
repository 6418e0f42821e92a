// SPDX-License-Identifier: Apache-2.0
// What a robot uploads: a run of consecutive keyframes of one mission, what it saw from them, and
// the loop closures it knows of. Every `index` is a keyframe's index in its mission.
#ifndef OVERTONE_CORE_GRAPH_SUBMAP_H_
#define OVERTONE_CORE_GRAPH_SUBMAP_H_

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "overtone/core/common/ids.h"
#include "overtone/core/common/timestamp.h"
#include "overtone/core/geometry/se3.h"
#include "overtone/core/graph/point_cloud.h"

namespace overtone {

struct Keyframe {
  Timestamp stamp;  // robot clock, strictly increasing within a mission
  // Odometry, metres; never corrected by the server's constraints, else they would be counted
  // twice.
  Rigid3d mission_from_body;
  // Covariance of the motion from the previous keyframe to this one (right tangent, m^2 and rad^2),
  // positive definite. The mission's first keyframe has no previous one; its value is not read.
  Matrix6d motion_covariance = Matrix6d::Identity();
  // The robot's own word that this motion was poorly observed (corridor, slip).
  bool degenerate = false;
  // Along which direction (unit, in this keyframe's body frame), when it knows; zero: any.
  Eigen::Vector3d degenerate_direction = Eigen::Vector3d::Zero();
};

// A measured relative pose between two keyframes, of one mission or of two.
struct LoopClosure {
  NodeId from;
  NodeId to;
  Rigid3d from_tform_to;
  Matrix6d covariance = Matrix6d::Identity();  // right tangent of from_tform_to, positive definite
};

// "These two look like the same place", without a relative pose.
struct ScoredCandidate {
  NodeId from;
  NodeId to;
  double score = 0;  // similarity, [0, 1]
};

// Points that belong to a keyframe, in its body frame. Over the wire they travel apart from the
// submap, under the SHA-256 of their encoding.
struct KeyframeCloud {
  int64_t index = 0;
  std::shared_ptr<const PointCloud> cloud;  // null: known by its digest only
  std::string sha256;                       // 32 bytes; empty: not encoded yet
  int64_t encoded_bytes = 0;
};

// A landmark whose identity is known: a fiducial, a barcode, an anchor.
struct LandmarkSighting {
  int64_t index = 0;
  std::string landmark;  // id rule of ids.h; the same for all robots of the map
  Eigen::Vector3d point_in_body = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();  // m^2, body axes, positive definite
};

// Another robot, recognised: where the origin of its body was at the keyframe's stamp. Clocks of
// the robots must agree to what its speed allows.
struct RobotSighting {
  int64_t index = 0;
  std::string robot;
  Eigen::Vector3d point_in_body = Eigen::Vector3d::Zero();
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Identity();
};

// GNSS, surveyed start, total station. Where only the position is known, the rotation's variances
// are large (1e4 rad^2).
struct AbsolutePose {
  int64_t index = 0;
  Rigid3d map_from_body;
  Matrix6d covariance = Matrix6d::Identity();  // right tangent of map_from_body, positive definite
};

struct Submap {
  int64_t sequence = 0;  // counts from 0 per mission, without gaps
  int64_t first_index =
      0;  // index of keyframes[0] in the mission; follows the previous submap's last
  std::vector<Keyframe> keyframes;
  std::vector<LoopClosure> loop_closures;   // at least one end in this mission
  std::vector<ScoredCandidate> candidates;  // likewise
  // Of this submap's own keyframes; of clouds, at most one for each.
  std::vector<KeyframeCloud> clouds;
  std::vector<LandmarkSighting> landmark_sightings;
  std::vector<RobotSighting> robot_sightings;
  std::vector<AbsolutePose> absolute_poses;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_GRAPH_SUBMAP_H_
