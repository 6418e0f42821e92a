// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/aligned_rmse.h"

#include <cmath>

#include "overtone/core/geometry/rigid_alignment.h"

namespace overtone {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points Positions(const std::vector<Rigid3d>& poses) {
  Points points;
  points.reserve(poses.size());
  for (const Rigid3d& pose : poses) points.push_back(pose.translation);
  return points;
}

Eigen::Vector3d Centroid(const Points& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

Rigid3d AlignLines(const Points& source, const Points& target) {
  Rigid3d motion;
  motion.rotation = Eigen::Quaterniond::FromTwoVectors(source.back() - source.front(),
                                                       target.back() - target.front());
  motion.translation = Centroid(target) - motion.rotation * Centroid(source);
  return motion;
}

}  // namespace

double AlignedRmse(const std::vector<Rigid3d>& estimate, const std::vector<Rigid3d>& reference) {
  return AlignedRmse(Positions(estimate), Positions(reference));
}

double AlignedRmse(const Points& source, const Points& target) {
  if (source.empty()) return 0;
  const auto aligned = UmeyamaAlignment(source, target, AlignmentMode::kSe3);
  const Rigid3d motion = aligned.ok() ? *aligned : AlignLines(source, target);
  double squares = 0;
  for (int i = 0; i < source.size(); ++i) squares += (motion * source[i] - target[i]).squaredNorm();
  return std::sqrt(squares / static_cast<double>(source.size()));
}

}  // namespace overtone
