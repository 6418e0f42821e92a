// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/radius_graph.h"

#include <gtest/gtest.h>

#include "overtone/tests/support/synthetic_graph.h"

namespace overtone {
namespace {

void ExpectSameAsFromTheAdjacency(const std::vector<Rigid3d>& poses,
                                  const RadiusGraphOptions& options) {
  const auto laplacian = RadiusGraphLaplacian(poses, options);
  const auto adjacency = RadiusGraphAdjacency(poses, options);
  ASSERT_TRUE(laplacian.ok() && adjacency.ok()) << laplacian.status() << adjacency.status();
  const SparseMatrix expected = GraphLaplacian(*adjacency);
  ASSERT_EQ(laplacian->nonZeros(), expected.nonZeros());
  EXPECT_LT((*laplacian - expected).norm(), 1e-13 * expected.norm() + 1e-300);
  EXPECT_TRUE(ValidateLaplacian(*laplacian).ok()) << ValidateLaplacian(*laplacian);
}

TEST(RadiusGraphLaplacian, IsTheLaplacianOfTheAdjacency) {
  const SyntheticTeam team = MakeSyntheticTeam(400);
  for (const DistanceMetric metric : {DistanceMetric::kSe3, DistanceMetric::kSo3Trace}) {
    RadiusGraphOptions options;
    options.metric = metric;
    ExpectSameAsFromTheAdjacency(team.server, options);
  }
}

TEST(RadiusGraphLaplacian, LeavesOutWeightsThatUnderflow) {
  const SyntheticTeam team = MakeSyntheticTeam(100);
  RadiusGraphOptions options;
  options.sigma = 0.03;  // exp(-1.34 m / (2 sigma^2)) is 0
  ExpectSameAsFromTheAdjacency(team.server, options);
  RadiusGraphOptions wide;
  EXPECT_LT(RadiusGraphLaplacian(team.server, options)->nonZeros(),
            RadiusGraphLaplacian(team.server, wide)->nonZeros());
}

TEST(RadiusGraphLaplacian, HoldsOneEntryForALonelyNode) {
  std::vector<Rigid3d> poses;
  for (const int n : {0, 1, 2}) {
    const auto laplacian = RadiusGraphLaplacian(poses, RadiusGraphOptions());
    ASSERT_TRUE(laplacian.ok()) << laplacian.status();
    EXPECT_EQ(laplacian->rows(), n);
    EXPECT_EQ(laplacian->nonZeros(), n);
    EXPECT_EQ(laplacian->norm(), 0);
    poses.emplace_back(Eigen::Quaterniond::Identity(), Eigen::Vector3d(100 * n, 0, 0));
  }
}

}  // namespace
}  // namespace overtone
