// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/discrepancy_filter.h"

#include <limits>
#include <random>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/spectral/radius_graph.h"
#include "overtone/core/synchronization/wavelet_discrepancy.h"
#include "overtone/tests/support/synthetic_graph.h"

namespace overtone {
namespace {

constexpr int kNumNodes = 300;

// All nodes a little off, `metres` at most, and differently for each seed.
std::vector<Rigid3d> Jittered(const std::vector<Rigid3d>& poses, double metres, int seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-metres / 2, metres / 2);
  std::vector<Rigid3d> moved = poses;
  for (Rigid3d& pose : moved) {
    pose.translation += Eigen::Vector3d(uniform(random), uniform(random), uniform(random));
  }
  return moved;
}

Eigen::MatrixXd Fresh(const std::vector<Rigid3d>& poses, const Eigen::MatrixXd& difference,
                      FilterMethod method = FilterMethod::kFast) {
  WaveletOptions options;
  options.method = method;
  const auto discrepancy =
      WaveletDiscrepancy(*RadiusGraphLaplacian(poses, RadiusGraphOptions()), difference, options);
  EXPECT_TRUE(discrepancy.ok()) << discrepancy.status();
  return *discrepancy;
}

// Largest difference over the largest entry.
double RelativeError(const Eigen::MatrixXd& actual, const Eigen::MatrixXd& expected) {
  return (actual - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}

class DiscrepancyFilterTest : public testing::Test {
 protected:
  Eigen::MatrixXd Filter(const std::vector<Rigid3d>& poses, const Eigen::MatrixXd& difference) {
    const auto discrepancy = filter_.Filter(poses, difference);
    EXPECT_TRUE(discrepancy.ok()) << discrepancy.status();
    return *discrepancy;
  }

  const SyntheticTeam team_ = MakeSyntheticTeam(kNumNodes);
  const Eigen::MatrixXd difference_ = team_.LogDifferenceSignal();
  DiscrepancyFilter filter_{RadiusGraphOptions(), WaveletOptions()};
};

TEST_F(DiscrepancyFilterTest, TheFirstRevisionIsComputedInFull) {
  EXPECT_EQ(Filter(team_.server, difference_), Fresh(team_.server, difference_));
  EXPECT_FALSE(filter_.reused_graph());
  EXPECT_FALSE(filter_.reused_coefficients());
}

// Thirty small changes: psi stays that of the first revision, and the errors do not add up.
TEST_F(DiscrepancyFilterTest, FollowsSmallChangesOnTheSameGraph) {
  (void)Filter(team_.server, difference_);
  Eigen::MatrixXd difference = difference_;
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  int num_reused = 0;
  for (int revision = 1; revision <= 30; ++revision) {
    for (double& entry : difference.reshaped()) entry *= 1 + 0.003 * normal(random);
    const Eigen::MatrixXd followed =
        Filter(Jittered(team_.server, /*metres=*/0.02, revision), difference);
    EXPECT_TRUE(filter_.reused_graph());
    num_reused += filter_.reused_coefficients();
    if (revision % 10 != 0) continue;
    const Eigen::MatrixXd exact = Fresh(team_.server, difference, FilterMethod::kExact);
    EXPECT_LT(RelativeError(followed, exact), 5e-4) << "revision " << revision;
  }
  EXPECT_GE(num_reused, 15);
}

TEST_F(DiscrepancyFilterTest, NothingNewCostsNothing) {
  const Eigen::MatrixXd first = Filter(team_.server, difference_);
  EXPECT_EQ(Filter(team_.server, difference_), first);
  EXPECT_TRUE(filter_.reused_coefficients());
}

TEST_F(DiscrepancyFilterTest, AnotherSignalIsFilteredInFullOnTheSameGraph) {
  (void)Filter(team_.server, difference_);
  const Eigen::MatrixXd other = -2 * difference_;
  EXPECT_LT(RelativeError(Filter(team_.server, other), Fresh(team_.server, other)), 2e-4);
  EXPECT_TRUE(filter_.reused_graph());
  EXPECT_FALSE(filter_.reused_coefficients());
}

TEST_F(DiscrepancyFilterTest, TheWholeMapMayMoveRigidly) {
  (void)Filter(team_.server, difference_);
  std::vector<Rigid3d> moved = team_.server;
  const Rigid3d motion(ExpSO3({0.3, -0.2, 2}), Eigen::Vector3d(100, -40, 7));
  for (Rigid3d& pose : moved) pose = motion * pose;
  (void)Filter(moved, difference_);
  EXPECT_TRUE(filter_.reused_graph());
}

TEST_F(DiscrepancyFilterTest, AMovedTurnedOrNewNodeBuildsTheGraphAnew) {
  std::vector<std::vector<Rigid3d>> revisions(2, team_.server);
  revisions[0][150].translation.x() += 0.1;
  revisions[1][150].rotation = revisions[1][150].rotation * ExpSO3({0, 0, 0.02});
  for (const std::vector<Rigid3d>& revision : revisions) {
    (void)Filter(team_.server, difference_);
    EXPECT_EQ(Filter(revision, difference_), Fresh(revision, difference_));
    EXPECT_FALSE(filter_.reused_graph());
  }
  std::vector<Rigid3d> shorter = team_.server;
  shorter.pop_back();
  const Eigen::MatrixXd shorter_difference = difference_.topRows(kNumNodes - 1);
  EXPECT_EQ(Filter(shorter, shorter_difference), Fresh(shorter, shorter_difference));
}

TEST_F(DiscrepancyFilterTest, KeepsNothingAfterAnError) {
  (void)Filter(team_.server, difference_);
  Eigen::MatrixXd bad = difference_;
  bad(3, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(filter_.Filter(team_.server, bad).status().code(), absl::StatusCode::kInvalidArgument);
  std::vector<Rigid3d> apart(kNumNodes);
  for (int i = 0; i < kNumNodes; ++i) apart[i].translation.x() = 100 * i;
  EXPECT_EQ(filter_.Filter(apart, difference_).status().code(),
            absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(Filter(team_.server, difference_), Fresh(team_.server, difference_));
}

}  // namespace
}  // namespace overtone
