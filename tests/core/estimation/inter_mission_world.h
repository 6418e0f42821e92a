// SPDX-License-Identifier: Apache-2.0
// Two missions through one place, their odometry drifted, and loop closures between them, right or
// wrong.
#ifndef OVERTONE_TESTS_CORE_ESTIMATION_INTER_MISSION_WORLD_H_
#define OVERTONE_TESTS_CORE_ESTIMATION_INTER_MISSION_WORLD_H_

#include <random>
#include <vector>

#include "Eigen/Cholesky"
#include "overtone/core/estimation/pairwise_consistency.h"
#include "overtone/tests/core/estimation/pose_graph_test_support.h"

namespace overtone {

class InterMissionWorld {
 public:
  static constexpr int kNumPoses = 300;

  // noise: 1 as the covariances say, 0 none.
  InterMissionWorld(double noise, std::mt19937& random) : noise_(noise) {
    // 300 m of random walk, mostly level.
    const Rigid3d start_b = RandomPose(random);
    Walk(Rigid3d(), random, truth_a, a);
    Walk(start_b, random, truth_b, b);
  }

  InterMissionClosure RightClosure(std::mt19937& random) const {
    InterMissionClosure closure = Blank(random);
    closure.from_tform_to = truth_a[closure.from].Inverse() * truth_b[closure.to] *
                            Exp(noise_ * Sample(closure.covariance, random));
    return closure;
  }

  // As confident as a right one, and anywhere: 10 m and any direction off.
  InterMissionClosure WrongClosure(std::mt19937& random) const {
    InterMissionClosure closure = RightClosure(random);
    Vector6d off = RandomVector(random, 1);
    off.head<3>() *= 10;
    closure.from_tform_to = closure.from_tform_to * Exp(off);
    return closure;
  }

  std::vector<Rigid3d> truth_a, truth_b;
  UncertainTrajectory a, b;  // as by odometry, each in a frame of its own

 private:
  static Vector6d Sample(const Matrix6d& covariance, std::mt19937& random) {
    return covariance.llt().matrixL() * RandomVector(random, 1);
  }

  static InterMissionClosure Blank(std::mt19937& random) {
    InterMissionClosure closure;
    closure.from = static_cast<int>(random() % kNumPoses);
    closure.to = static_cast<int>(random() % kNumPoses);
    closure.covariance = 1e-6 * RandomInformation(random);
    closure.covariance.topLeftCorner<3, 3>() += 0.0025 * Eigen::Matrix3d::Identity();
    closure.covariance.bottomRightCorner<3, 3>() += 1e-4 * Eigen::Matrix3d::Identity();
    return closure;
  }

  // 1 cm and 0.2 degrees for each metre.
  void Walk(const Rigid3d& start, std::mt19937& random, std::vector<Rigid3d>& truth,
            UncertainTrajectory& odometry) const {
    Vector6d sigma;
    sigma << 0.01, 0.01, 0.01, 0.0035, 0.0035, 0.0035;
    const Matrix6d covariance = sigma.cwiseAbs2().asDiagonal();
    Rigid3d pose = start, measured;
    for (int i = 0; i < kNumPoses; ++i) {
      truth.push_back(pose);
      odometry.Append(measured, covariance);
      Vector6d step = RandomVector(random, 0.05);
      step(0) += 1;
      step(5) += 0.05;
      pose = pose * Exp(step);
      measured = measured * Exp(step) * Exp(noise_ * Sample(covariance, random));
    }
  }

  const double noise_;
};

}  // namespace overtone

#endif  // OVERTONE_TESTS_CORE_ESTIMATION_INTER_MISSION_WORLD_H_
