// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/uncertain_trajectory.h"

#include "gtest/gtest.h"
#include "overtone/tests/core/estimation/pose_graph_test_support.h"

namespace overtone {
namespace {

struct Chain {
  std::vector<Rigid3d> poses;
  std::vector<Matrix6d> covariances;
  UncertainTrajectory trajectory;
};

Chain RandomChain(int num_poses, const Rigid3d& start, std::mt19937& random) {
  Chain chain;
  Rigid3d pose = start;
  for (int i = 0; i < num_poses; ++i) {
    chain.poses.push_back(pose);
    chain.covariances.push_back(1e-4 * RandomInformation(random));
    chain.trajectory.Append(pose, chain.covariances.back());
    pose = pose * RandomPose(random);
  }
  return chain;
}

// Cov(T_ij * T_jk) = Ad(T_jk^-1) Cov(T_ij) Ad(T_jk^-1)^T + Cov(T_jk), motion by motion.
TEST(UncertainTrajectory, CovarianceIsThatOfTheMotionsComposedOneByOne) {
  std::mt19937 random(1);
  const Chain chain = RandomChain(20, RandomPose(random), random);
  Matrix6d expected = Matrix6d::Zero();
  for (int k = 5; k < 20; ++k) {
    if (k > 5) {
      const Matrix6d adjoint = Adjoint(chain.trajectory.Relative(k, k - 1));
      expected = adjoint * expected * adjoint.transpose() + chain.covariances[k];
    }
    EXPECT_LT((chain.trajectory.Covariance(5, k) - expected).norm(), 1e-9 * (1 + expected.norm()));
    EXPECT_LT(Distance(chain.trajectory.Relative(5, k), chain.poses[5].Inverse() * chain.poses[k]),
              1e-9);
  }
}

// Cov(T^-1) = Ad(T) Cov(T) Ad(T)^T.
TEST(UncertainTrajectory, BackwardsIsTheCovarianceOfTheInverse) {
  std::mt19937 random(2);
  const Chain chain = RandomChain(10, RandomPose(random), random);
  const Matrix6d adjoint = Adjoint(chain.trajectory.Relative(2, 7));
  const Matrix6d expected = adjoint * chain.trajectory.Covariance(2, 7) * adjoint.transpose();
  EXPECT_LT((chain.trajectory.Covariance(7, 2) - expected).norm(), 1e-9 * expected.norm());
}

TEST(UncertainTrajectory, IsTheSameWhereverTheWorldHasItsOrigin) {
  std::mt19937 random(3), again(3);
  const Chain near = RandomChain(30, Rigid3d(), random);
  const Chain far =
      RandomChain(30, Rigid3d(Eigen::Quaterniond::Identity(), {5e6, 4e5, 300}), again);
  const Matrix6d expected = near.trajectory.Covariance(3, 25);
  EXPECT_LT((far.trajectory.Covariance(3, 25) - expected).norm(), 1e-6 * expected.norm());
}

TEST(UncertainTrajectory, GoesAnotherWayFromWhereItWasCut) {
  std::mt19937 random(4);
  Chain chain = RandomChain(70, Rigid3d(), random);
  UncertainTrajectory expected;
  for (int i = 0; i < 70; ++i) {
    if (i >= 33) chain.poses[i] = chain.poses[i] * Exp(RandomVector(random, 0.3));
    expected.Append(chain.poses[i], chain.covariances[i]);
  }
  chain.trajectory.Truncate(33);
  EXPECT_EQ(chain.trajectory.Size(), 33);
  for (int i = 33; i < 70; ++i) chain.trajectory.Append(chain.poses[i], chain.covariances[i]);
  EXPECT_EQ(chain.trajectory.Size(), 70);
  EXPECT_EQ(chain.trajectory.Covariance(20, 68), expected.Covariance(20, 68));
  EXPECT_LT(Distance(chain.trajectory.Relative(20, 68), expected.Relative(20, 68)), 1e-12);
}

// Against samples of the noise itself.
TEST(UncertainTrajectory, PredictsTheSpreadOfSampledTrajectories) {
  std::mt19937 random(5);
  constexpr int kSamples = 4000;
  const Chain chain = RandomChain(6, Rigid3d(), random);
  Matrix6d spread = Matrix6d::Zero();
  for (int s = 0; s < kSamples; ++s) {
    Rigid3d sampled;
    for (int j = 2; j < 6; ++j) {
      const Matrix6d root = chain.covariances[j].llt().matrixL();
      sampled = sampled * chain.trajectory.Relative(j - 1, j) * Exp(root * RandomVector(random, 1));
    }
    const Vector6d error = Log(chain.trajectory.Relative(1, 5).Inverse() * sampled);
    spread += error * error.transpose() / kSamples;
  }
  const Matrix6d predicted = chain.trajectory.Covariance(1, 5);
  EXPECT_LT((spread - predicted).norm(), 0.1 * predicted.norm());
}

}  // namespace
}  // namespace overtone
