// SPDX-License-Identifier: Apache-2.0
// What odometry alone said, whatever a host's estimator has made of it since.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_ODOMETRY_RECORD_H_
#define OVERTONE_CORE_SYNCHRONIZATION_ODOMETRY_RECORD_H_

#include <cstdint>
#include <map>
#include <vector>

#include "overtone/core/graph/submap.h"
#include "overtone/core/synchronization/node_association.h"
#include "overtone/core/synchronization/odometry_model.h"

namespace overtone {

// Poses along a mission by odometry, and what each step is good to.
struct OdometryChain {
  std::vector<Rigid3d> poses;             // in the frame of the first node
  std::vector<Matrix6d> step_covariance;  // right tangent, of the motion into each; [0] unused
};

// For one mission. Not thread-safe. Some 300 bytes for each keyframe.
class OdometryRecord {
 public:
  // Keyframes as they are uploaded: their poses are odometry's own, their covariances the host's.
  void AddKeyframes(int64_t first_index, const std::vector<Keyframe>& keyframes);

  // The host's estimate, before anything is done about it: steps between neighbours that were not
  // known are kept as they are now, with the model's covariance. A step at the end of a trajectory
  // is odometry still, whatever was corrected before it. `trajectory`: index increasing.
  void Observe(const std::vector<NodePose>& trajectory, const OdometryModel& model);

  // Along `nodes` (index increasing, at least one). A motion of which the record knows nothing is
  // the difference of the two poses given, by the model.
  OdometryChain Along(const std::vector<NodePose>& nodes, const OdometryModel& model) const;

 private:
  struct Step {
    int64_t previous = 0;
    Rigid3d previous_from_this;
    Eigen::Matrix<float, 6, 6> covariance;
  };

  std::map<int64_t, Step> steps_;  // by the index they lead to
  int64_t last_uploaded_ = -1;
  Rigid3d last_uploaded_pose_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_ODOMETRY_RECORD_H_
