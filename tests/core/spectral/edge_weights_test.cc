// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/edge_weights.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "Eigen/Eigenvalues"
#include "overtone/core/spectral/graph_fourier_transform.h"
#include "overtone/core/spectral/graph_laplacian.h"
#include "overtone/core/spectral/meyer_wavelets.h"
#include "overtone/tests/support/golden_case.h"
#include "overtone/tests/support/synthetic_graph.h"

namespace overtone {
namespace {

Rigid3d RandomPose(std::mt19937& generator, double angle_scale) {
  std::normal_distribution<double> normal;
  Vector6d xi;
  for (double& entry : xi) entry = normal(generator);
  xi.head<3>() *= 3;
  xi.tail<3>() *= angle_scale;
  return Exp(xi);
}

Rigid3d At(double x, double y, double z) {
  return Rigid3d(Eigen::Quaterniond::Identity(), {x, y, z});
}

// The closed form against tr(Xi M Xi^T) with the matrix logarithm written out.
TEST(PoseDistance, Se3IsTheTraceFormulaForAnyWeights) {
  std::mt19937 generator(1);
  const MetricWeights weights{Eigen::Vector4d(10, 2, 0.3, 0.7)};
  for (const double scale : {1e-10, 1e-6, 0.1, 1.0, 3.0}) {
    const Rigid3d a = RandomPose(generator, 1), b = a * RandomPose(generator, scale);
    const Vector6d xi = Log(a.Inverse() * b);
    Eigen::Matrix4d wedge = Eigen::Matrix4d::Zero();
    wedge.topLeftCorner<3, 3>() = Skew(xi.tail<3>());
    wedge.topRightCorner<3, 1>() = xi.head<3>();
    const double expected =
        std::sqrt((wedge * weights.diagonal.asDiagonal() * wedge.transpose()).trace());
    EXPECT_NEAR(PoseDistance(a, b, DistanceMetric::kSe3, weights), expected,
                1e-12 * (1 + expected));
    EXPECT_NEAR(PoseDistance(b, a, DistanceMetric::kSe3, weights), expected,
                1e-12 * (1 + expected));
  }
}

TEST(PoseDistance, OfAQuarterTurnInPlace) {
  const Rigid3d a = At(1, 2, 3), b(ExpSO3({0, 0, M_PI / 2}), {1, 2, 3});
  EXPECT_NEAR(PoseDistance(a, b, DistanceMetric::kSe3, {}), std::sqrt(2.0) * M_PI / 2, 1e-14);
  EXPECT_NEAR(PoseDistance(a, b, DistanceMetric::kSo3, {}), M_PI / 2, 1e-14);
  EXPECT_NEAR(PoseDistance(a, b, DistanceMetric::kSo3Trace, {}), 1, 1e-14);
  EXPECT_EQ(PoseDistance(a, b, DistanceMetric::kR3, {}), 0);
}

TEST(PoseDistance, DoesNotCareForTheQuaternionsSign) {
  std::mt19937 generator(2);
  const Rigid3d a = RandomPose(generator, 1), b = RandomPose(generator, 1);
  const Rigid3d flipped(Eigen::Quaterniond(-b.rotation.coeffs()), b.translation);
  for (const auto metric : {DistanceMetric::kSe3, DistanceMetric::kR3, DistanceMetric::kSo3,
                            DistanceMetric::kSo3Trace}) {
    EXPECT_NEAR(PoseDistance(a, b, metric, {}), PoseDistance(a, flipped, metric, {}), 1e-13);
  }
}

TEST(RadiusGraphAdjacency, TakesTheBallAsClosed) {
  RadiusGraphOptions options;
  options.radius_m = 5;
  const auto adjacency =
      RadiusGraphAdjacency({At(0, 0, 0), At(3, 4, 0), At(0, 0, 5 + 1e-9)}, options);
  ASSERT_TRUE(adjacency.ok()) << adjacency.status();
  EXPECT_NEAR(adjacency->coeff(0, 1), std::exp(-2.5), 1e-15);
  EXPECT_EQ(adjacency->coeff(0, 2), 0);
  EXPECT_EQ(adjacency->nonZeros(), 2);
}

TEST(RadiusGraphAdjacency, FindsTheSameEdgesAsAllPairs) {
  const SyntheticTeam team = MakeSyntheticTeam(300, /*seed=*/5);
  RadiusGraphOptions options;
  options.radius_m = 3;
  options.sigma = 2;
  const auto adjacency = RadiusGraphAdjacency(team.server, options);
  ASSERT_TRUE(adjacency.ok()) << adjacency.status();
  int edges = 0;
  for (int i = 0; i < 300; ++i) {
    for (int j = 0; j < 300; ++j) {
      const bool near =
          i != j && (team.server[i].translation - team.server[j].translation).norm() <= 3;
      const double distance =
          PoseDistance(team.server[i], team.server[j], DistanceMetric::kSe3, {});
      EXPECT_NEAR(adjacency->coeff(i, j), near ? std::exp(-distance / 8) : 0, 1e-15);
      edges += near;
    }
  }
  EXPECT_EQ(adjacency->nonZeros(), edges);
}

TEST(RadiusGraphAdjacency, OfNoneOrOnePoseHasNoEdges) {
  EXPECT_EQ(RadiusGraphAdjacency({}, {})->rows(), 0);
  EXPECT_EQ(RadiusGraphAdjacency({At(1, 1, 1)}, {})->rows(), 1);
}

TEST(RadiusGraphAdjacency, JoinsPosesThatCoincide) {
  const auto adjacency = RadiusGraphAdjacency(std::vector<Rigid3d>(50, At(1, 1, 1)), {});
  ASSERT_TRUE(adjacency.ok()) << adjacency.status();
  EXPECT_EQ(adjacency->nonZeros(), 50 * 49);
  EXPECT_EQ(adjacency->coeff(3, 4), 1);
}

TEST(RadiusGraphAdjacency, RefusesPosesAndOptionsThatAreNotFinite) {
  for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e200}) {
    const auto adjacency = RadiusGraphAdjacency({At(0, 0, 0), At(0, bad, 0)}, {});
    EXPECT_TRUE(absl::IsInvalidArgument(adjacency.status())) << bad;
    EXPECT_NE(adjacency.status().message().find("poses[1]"), std::string::npos);
    Rigid3d turned;
    turned.rotation.x() = bad;
    if (!std::isfinite(bad)) {
      EXPECT_FALSE(RadiusGraphAdjacency({turned}, {}).ok());
    }
  }
  EXPECT_TRUE(RadiusGraphOptions().Validate().ok());
  for (const double bad : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    RadiusGraphOptions radius, sigma;
    radius.radius_m = bad;
    sigma.sigma = bad;
    EXPECT_TRUE(absl::IsInvalidArgument(RadiusGraphAdjacency({}, radius).status())) << bad;
    EXPECT_TRUE(absl::IsInvalidArgument(RadiusGraphAdjacency({}, sigma).status())) << bad;
  }
  RadiusGraphOptions weights;
  weights.weights.diagonal[2] = -1;
  EXPECT_TRUE(absl::IsInvalidArgument(weights.Validate()));
}

TEST(GraphLaplacian, RowsSumToZeroAndItIsPositiveSemiDefinite) {
  const SparseMatrix laplacian = MakeSyntheticTeam(150).Laplacian();
  EXPECT_LT((laplacian * Eigen::VectorXd::Ones(150)).cwiseAbs().maxCoeff(), 1e-12);
  const Eigen::MatrixXd dense = laplacian;
  EXPECT_GT(dense.selfadjointView<Eigen::Lower>().eigenvalues().minCoeff(), -1e-12);
  EXPECT_TRUE(ValidateLaplacian(laplacian).ok());
  EXPECT_LT((GraphLaplacian(AdjacencyFromLaplacian(laplacian)) - laplacian).norm(), 1e-12);
}

TEST(ValidateLaplacian, SaysWhatIsWrong) {
  const SparseMatrix path = PathGraphLaplacian(4);
  SparseMatrix sum = path, asymmetric = path, infinite = path;
  sum.coeffRef(1, 1) += 0.1;
  asymmetric.coeffRef(0, 1) -= 0.1;
  asymmetric.coeffRef(1, 1) += 0.1;
  infinite.coeffRef(2, 2) = std::numeric_limits<double>::infinity();
  for (const SparseMatrix& bad :
       {sum, asymmetric, infinite, SparseMatrix(-path), SparseMatrix(3, 4)}) {
    EXPECT_TRUE(absl::IsInvalidArgument(ValidateLaplacian(bad)));
  }
}

// lambda_k = 2 - 2 cos(pi k / n).
TEST(GraphFourierTransform, OfAPathIsTheCosineTransform) {
  const auto spectrum = GraphFourierTransform(PathGraphLaplacian(12));
  ASSERT_TRUE(spectrum.ok()) << spectrum.status();
  for (int k = 0; k < 12; ++k)
    EXPECT_NEAR(spectrum->eigenvalues[k], 2 - 2 * std::cos(M_PI * k / 12), 1e-13);
  EXPECT_LT((spectrum->eigenvectors.transpose() * spectrum->eigenvectors -
             Eigen::MatrixXd::Identity(12, 12))
                .norm(),
            1e-13);
}

TEST(GraphFourierTransform, OfAStarIsZeroOnesAndN) {
  const auto spectrum = GraphFourierTransform(StarGraphLaplacian(9));
  ASSERT_TRUE(spectrum.ok()) << spectrum.status();
  EXPECT_EQ(spectrum->eigenvalues[0], 0);
  for (int k = 1; k < 8; ++k) EXPECT_NEAR(spectrum->eigenvalues[k], 1, 1e-13);
  EXPECT_NEAR(spectrum->largest_eigenvalue(), 9, 1e-13);
}

TEST(MeyerFilterBank, IsATightFrameUpToLmax) {
  for (int scales = 3; scales <= 9; ++scales) {
    const Eigen::MatrixXd kernels =
        MeyerFilterBank(3.7, scales).Evaluate(Eigen::VectorXd::LinSpaced(5000, 0, 3.7));
    EXPECT_LT((kernels.colwise().squaredNorm().array() - 1).abs().maxCoeff(), 1e-13) << scales;
  }
}

TEST(MeyerFilterBank, OfAGraphWithoutEdgesIsTheScalingKernelAlone) {
  const MeyerFilterBank bank(/*lmax=*/0, 6);
  EXPECT_EQ(bank.Evaluate(0, 0), 1);
  for (int s = 1; s < 6; ++s) EXPECT_EQ(bank.Evaluate(s, 0), 0);
}

TEST(MeyerFilterBank, MatchesTheGoldenKernels) {
  int tables = 0;
  for (const auto& folder : {golden::CommittedFolder(), golden::SharedFolder()}) {
    if (!std::filesystem::is_directory(folder / "meyer_kernel")) continue;
    for (const auto& entry : std::filesystem::directory_iterator(folder / "meyer_kernel")) {
      double lmax;
      int scales;
      if (std::sscanf(entry.path().filename().c_str(), "lmax%lf_s%d.csv", &lmax, &scales) != 2)
        continue;
      const golden::Table table(entry.path());
      const Eigen::MatrixXd kernels =
          MeyerFilterBank(lmax, scales).Evaluate(table.Column("lambda")).transpose();
      EXPECT_LT((kernels - table.Columns("g")).cwiseAbs().maxCoeff(), 1e-13) << entry.path();
      ++tables;
    }
  }
  EXPECT_GE(tables, 2);
}

}  // namespace
}  // namespace overtone
