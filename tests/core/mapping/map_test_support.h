// SPDX-License-Identifier: Apache-2.0
// Small missions and closures with known truth for the tests of the map.
#ifndef OVERTONE_TESTS_CORE_MAPPING_MAP_TEST_SUPPORT_H_
#define OVERTONE_TESTS_CORE_MAPPING_MAP_TEST_SUPPORT_H_

#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "overtone/core/graph/submap.h"

namespace overtone {

inline Matrix6d Covariance(double translation_sigma_m, double rotation_sigma_rad) {
  Vector6d variances;
  variances << Eigen::Vector3d::Constant(translation_sigma_m * translation_sigma_m),
      Eigen::Vector3d::Constant(rotation_sigma_rad * rotation_sigma_rad);
  return variances.asDiagonal();
}

inline Rigid3d Planar(double x, double y, double yaw) {
  return Rigid3d(ExpSO3({0, 0, yaw}), {x, y, 0});
}

inline MissionId Mission(const std::string& robot) { return {robot, "m0"}; }

// Keyframes 0.1 s apart at the given odometry poses.
inline Submap MakeSubmap(int64_t sequence, int64_t first_index,
                         const std::vector<Rigid3d>& mission_from_body,
                         const Matrix6d& motion_covariance = Covariance(0.01, 0.002)) {
  Submap submap;
  submap.sequence = sequence;
  submap.first_index = first_index;
  for (size_t i = 0; i < mission_from_body.size(); ++i) {
    Keyframe keyframe;
    keyframe.stamp.ns =
        1'700'000'000'000'000'000 + (first_index + static_cast<int64_t>(i)) * 100'000'000;
    keyframe.mission_from_body = mission_from_body[i];
    keyframe.motion_covariance = motion_covariance;
    submap.keyframes.push_back(keyframe);
  }
  return submap;
}

inline LoopClosure MakeClosure(const NodeId& from, const NodeId& to, const Rigid3d& from_tform_to,
                               const Matrix6d& covariance = Covariance(0.02, 0.005)) {
  return {from, to, from_tform_to, covariance};
}

// n poses, 1 m apart, once around a circle of matching circumference that begins at the origin
// along x.
inline std::vector<Rigid3d> CirclePoses(int n) {
  std::vector<Rigid3d> poses;
  const double turn = 2 * M_PI / n;
  const double radius = 1 / turn;
  for (int i = 0; i < n; ++i) {
    const double angle = i * turn;
    poses.push_back(Planar(radius * std::sin(angle), radius * (1 - std::cos(angle)), angle));
  }
  return poses;
}

inline Vector6d Noise(const Matrix6d& covariance, std::mt19937& random) {
  std::normal_distribution<double> normal;
  Vector6d noise;
  for (int i = 0; i < 6; ++i) noise(i) = std::sqrt(covariance(i, i)) * normal(random);
  return noise;
}

// What odometry with that noise makes of a true path; starts at mission_from_first.
inline std::vector<Rigid3d> Drifted(const std::vector<Rigid3d>& truth,
                                    const Rigid3d& mission_from_first, const Matrix6d& covariance,
                                    std::mt19937& random) {
  std::vector<Rigid3d> odometry = {mission_from_first};
  for (size_t i = 1; i < truth.size(); ++i) {
    odometry.push_back(odometry.back() * (truth[i - 1].Inverse() * truth[i]) *
                       Exp(Noise(covariance, random)));
  }
  return odometry;
}

}  // namespace overtone

#endif  // OVERTONE_TESTS_CORE_MAPPING_MAP_TEST_SUPPORT_H_
