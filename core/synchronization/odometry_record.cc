// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/odometry_record.h"

namespace overtone {

void OdometryRecord::AddKeyframes(int64_t first_index, const std::vector<Keyframe>& keyframes) {
  int64_t index = first_index;
  for (const Keyframe& keyframe : keyframes) {
    if (index > 0 && last_uploaded_ == index - 1) {
      steps_[index] = {index - 1, last_uploaded_pose_.Inverse() * keyframe.mission_from_body,
                       keyframe.motion_covariance.cast<float>()};
    }
    last_uploaded_ = index++;
    last_uploaded_pose_ = keyframe.mission_from_body;
  }
}

void OdometryRecord::Observe(const std::vector<NodePose>& trajectory, const OdometryModel& model) {
  for (int i = 1; i < trajectory.size(); ++i) {
    if (steps_.count(trajectory[i].index) > 0) continue;
    const Rigid3d motion =
        trajectory[i - 1].estimate_from_body.Inverse() * trajectory[i].estimate_from_body;
    steps_[trajectory[i].index] = {trajectory[i - 1].index, motion,
                                   OdometryCovariance(motion, model).cast<float>()};
  }
}

OdometryChain OdometryRecord::Along(const std::vector<NodePose>& nodes,
                                    const OdometryModel& model) const {
  OdometryChain chain;
  chain.poses.push_back(Rigid3d::Identity());
  chain.step_covariance.push_back(Matrix6d::Identity());
  for (int i = 1; i < nodes.size(); ++i) {
    // Backwards, step by step: (A Exp(a)) (B Exp(b)) = A B Exp(Ad(B^-1) a) Exp(b).
    Rigid3d step_from_node;
    Matrix6d covariance = Matrix6d::Zero();
    int64_t index = nodes[i].index;
    auto step = steps_.find(index);
    while (index > nodes[i - 1].index && step != steps_.end()) {
      const Matrix6d adjoint = Adjoint(step_from_node.Inverse());
      covariance += adjoint * step->second.covariance.cast<double>() * adjoint.transpose();
      step_from_node = step->second.previous_from_this * step_from_node;
      index = step->second.previous;
      if (index > nodes[i - 1].index) step = steps_.find(index);
    }
    if (index != nodes[i - 1].index) {
      step_from_node = nodes[i - 1].estimate_from_body.Inverse() * nodes[i].estimate_from_body;
      covariance = OdometryCovariance(step_from_node, model);
    }
    chain.poses.push_back(chain.poses.back() * step_from_node);
    chain.step_covariance.push_back(0.5 * (covariance + covariance.transpose()));
  }
  return chain;
}

}  // namespace overtone
