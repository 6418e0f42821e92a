// SPDX-License-Identifier: Apache-2.0
// A winding mission, and odometry that drifts along it as its covariance says.
#ifndef OVERTONE_TESTS_SUPPORT_DRIFTING_MISSION_H_
#define OVERTONE_TESTS_SUPPORT_DRIFTING_MISSION_H_

#include <cmath>
#include <random>
#include <vector>

#include "overtone/core/geometry/se3.h"
#include "overtone/core/synchronization/trajectory_comparison.h"

namespace overtone {

struct DriftingMission {
  std::vector<Rigid3d> truth;             // map_from_body; a good server's estimate
  std::vector<Rigid3d> odometry;          // another frame
  std::vector<Matrix6d> step_covariance;  // of the motion into each pose

  // Moves all of odometry from `row` on, as if the estimator had slipped there.
  void Slip(int row, const Rigid3d& slip) {
    const Rigid3d before = odometry[row - 1];
    for (int i = row; i < odometry.size(); ++i) {
      odometry[i] = before * slip * (before.Inverse() * odometry[i]);
    }
  }
};

// Rounds of a 12 m by 6 m ellipse with waves, 100 poses each.
inline DriftingMission MakeDriftingMission(int num_nodes, int seed,
                                           double sigma_translation_m = 0.02,
                                           double sigma_rotation_rad = 0.01) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  Vector6d sigma;
  sigma << Eigen::Vector3d::Constant(sigma_translation_m),
      Eigen::Vector3d::Constant(sigma_rotation_rad);
  DriftingMission mission;
  const Rigid3d start(ExpSO3({0.1, -0.2, 1}), Eigen::Vector3d(30, -20, 5));
  for (int i = 0; i < num_nodes; ++i) {
    const double t = 2 * M_PI * i / 100;
    mission.truth.emplace_back(ExpSO3({0, 0, t}), Eigen::Vector3d(12 * std::cos(t), 6 * std::sin(t),
                                                                  0.5 * std::sin(3.3 * t)));
    Vector6d noise;
    for (double& entry : noise) entry = normal(random);
    mission.odometry.push_back(i == 0 ? start
                                      : mission.odometry[i - 1] *
                                            (mission.truth[i - 1].Inverse() * mission.truth[i]) *
                                            Exp(sigma.cwiseProduct(noise)));
    mission.step_covariance.push_back(sigma.cwiseAbs2().asDiagonal());
  }
  return mission;
}

// As a comparison; keyframe index = 2 * row, so that who mixes them up is found out.
inline TrajectoryComparison ComparisonOf(const DriftingMission& mission) {
  TrajectoryComparison comparison;
  comparison.server = mission.truth;
  comparison.onboard = mission.odometry;
  for (int i = 0; i < mission.truth.size(); ++i) {
    comparison.keyframe_index.push_back(2 * i);
    comparison.submap_start.push_back(i % 20 == 0);
    comparison.degenerate.push_back(false);
  }
  comparison.discrepancy = Eigen::MatrixXd::Zero(mission.truth.size(), 3);
  comparison.revision = 3;
  return comparison;
}

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_DRIFTING_MISSION_H_
