// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/trajectory_signal.h"

namespace overtone {
namespace {

// tr(Xi M Xi^T) = sum_c (scale_c xi_c)^2: column j of phi^x holds the two components of phi other
// than phi_j.
Vector6d ChannelScales(const MetricWeights& weights) {
  const Eigen::Vector4d& m = weights.diagonal;
  Vector6d squared;
  squared << m[3], m[3], m[3], m[1] + m[2], m[0] + m[2], m[0] + m[1];
  return squared.cwiseSqrt();
}

}  // namespace

Eigen::MatrixXd TrajectorySignal(const std::vector<Rigid3d>& poses, SignalKind kind,
                                 DistanceMetric metric, const MetricWeights& weights) {
  const bool logarithm = kind == SignalKind::kSe3Log;
  Eigen::MatrixXd signal(poses.size(), logarithm ? 6 : 1);
  if (poses.empty()) return signal;
  const Rigid3d origin_from_map = poses.front().Inverse();
  const Vector6d scales = ChannelScales(weights);
  for (int i = 0; i < poses.size(); ++i) {
    if (logarithm) {
      signal.row(i) = scales.cwiseProduct(Log(origin_from_map * poses[i])).transpose();
    } else {
      signal(i, 0) = PoseDistance(poses.front(), poses[i], metric, weights);
    }
  }
  return signal;
}

}  // namespace overtone
