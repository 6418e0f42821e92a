// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/kron_reduction.h"

#include <gtest/gtest.h>

#include <numeric>

#include "Eigen/LU"
#include "Eigen/QR"
#include "overtone/core/spectral/reduction_node_selection.h"
#include "overtone/tests/support/golden_case.h"
#include "overtone/tests/support/synthetic_graph.h"

namespace overtone {
namespace {

using testing::TestWithParam;

// Between nodes a and b of a network of conductances: (e_a - e_b)^T L^+ (e_a - e_b).
double EffectiveResistance(const SparseMatrix& laplacian, int a, int b) {
  Eigen::VectorXd current = Eigen::VectorXd::Zero(laplacian.rows());
  current[a] = 1;
  current[b] = -1;
  const Eigen::MatrixXd dense = laplacian;
  return current.dot(dense.completeOrthogonalDecomposition().solve(current));
}

void ExpectLaplacian(const SparseMatrix& laplacian) {
  const Eigen::MatrixXd dense = laplacian;
  EXPECT_EQ(dense, dense.transpose());
  EXPECT_LT(dense.rowwise().sum().cwiseAbs().maxCoeff(), 1e-12 * (1 + dense.diagonal().maxCoeff()));
  const Eigen::MatrixXd off_diagonal = dense - Eigen::MatrixXd(dense.diagonal().asDiagonal());
  EXPECT_LE(off_diagonal.maxCoeff(), 0);
}

// Edge weights add like conductances: two unit edges in series act as one of 1/2.
TEST(KronReduction, EliminatingTheMiddleOfAPathHalvesTheWeight) {
  const auto reduced = KronReduction(PathGraphLaplacian(/*num_nodes=*/3), /*kept_nodes=*/{0, 2});
  ASSERT_TRUE(reduced.ok()) << reduced.status();
  EXPECT_NEAR(reduced->laplacian.coeff(0, 1), -0.5, 1e-15);
  EXPECT_NEAR(reduced->laplacian.coeff(0, 0), 0.5, 1e-15);
}

TEST(KronReduction, LongSeriesOfConductancesIsTheirHarmonicSum) {
  const auto reduced = KronReduction(PathGraphLaplacian(101, /*weight=*/2), {0, 100});
  ASSERT_TRUE(reduced.ok()) << reduced.status();
  EXPECT_NEAR(reduced->laplacian.coeff(0, 1), -2.0 / 100, 1e-14);
}

// A star of k unit edges becomes the complete graph of weights 1 / k.
TEST(KronReduction, EliminatingTheHubOfAStarLeavesItsMesh) {
  const auto reduced = KronReduction(StarGraphLaplacian(6), {1, 2, 3, 4, 5});
  ASSERT_TRUE(reduced.ok()) << reduced.status();
  EXPECT_LT(
      (Eigen::MatrixXd(reduced->laplacian) - Eigen::MatrixXd(CompleteGraphLaplacian(5)) / 5).norm(),
      1e-14);
}

TEST(KronReduction, CompleteGraphStaysCompleteWithWeightsNOverK) {
  const auto reduced = KronReduction(CompleteGraphLaplacian(10), {0, 3, 4, 9});
  ASSERT_TRUE(reduced.ok()) << reduced.status();
  EXPECT_LT(
      (Eigen::MatrixXd(reduced->laplacian) - 10.0 / 4 * Eigen::MatrixXd(CompleteGraphLaplacian(4)))
          .norm(),
      1e-13);
}

TEST(KronReduction, KeepingEverythingPermutes) {
  const SparseMatrix laplacian = RandomConnectedLaplacian(6, 5, /*seed=*/2);
  const std::vector<int> order = {4, 2, 0, 1, 5, 3};
  for (const auto& reduced :
       {KronReduction(laplacian, order), SparsifiedKronReduction(laplacian, order, 0)}) {
    ASSERT_TRUE(reduced.ok()) << reduced.status();
    for (int i = 0; i < 6; ++i) {
      for (int j = 0; j < 6; ++j) {
        EXPECT_NEAR(reduced->laplacian.coeff(i, j), laplacian.coeff(order[i], order[j]), 1e-15);
      }
    }
  }
}

class KronLaws : public TestWithParam<int> {};

TEST_P(KronLaws, EffectiveResistancesBetweenKeptNodesStay) {
  const SparseMatrix laplacian = RandomConnectedLaplacian(40, 60, GetParam());
  const std::vector<int> kept = {1, 5, 8, 13, 21, 34, 39};
  for (const auto& reduced :
       {KronReduction(laplacian, kept), SparsifiedKronReduction(laplacian, kept, 0)}) {
    ASSERT_TRUE(reduced.ok()) << reduced.status();
    ExpectLaplacian(reduced->laplacian);
    for (int a = 0; a < 7; ++a) {
      for (int b = a + 1; b < 7; ++b) {
        const double resistance = EffectiveResistance(laplacian, kept[a], kept[b]);
        EXPECT_NEAR(EffectiveResistance(reduced->laplacian, a, b), resistance, 1e-10 * resistance);
      }
    }
  }
}

// More than one block of right-hand sides, against the dense formula.
TEST_P(KronLaws, MatchesTheDenseSchurComplement) {
  const int n = 700, k = 400;
  const SparseMatrix laplacian = RandomConnectedLaplacian(n, 2000, GetParam());
  std::vector<int> kept(k);
  std::iota(kept.begin(), kept.end(), n - k);
  const Eigen::MatrixXd dense = laplacian;
  const Eigen::MatrixXd expected =
      dense.bottomRightCorner(k, k) -
      dense.bottomLeftCorner(k, n - k) *
          dense.topLeftCorner(n - k, n - k).partialPivLu().solve(dense.topRightCorner(n - k, k));
  const auto reduced = KronReduction(laplacian, kept);
  ASSERT_TRUE(reduced.ok()) << reduced.status();
  EXPECT_LT((Eigen::MatrixXd(reduced->laplacian) - expected).cwiseAbs().maxCoeff(), 1e-11);
  EXPECT_LT(reduced->largest_clipped_weight, 1e-13);
}

TEST_P(KronLaws, StarMeshWithoutToleranceIsTheExactReduction) {
  const SparseMatrix laplacian = MakeSyntheticTeam(200, GetParam()).Laplacian();
  std::vector<int> kept;
  for (int i = 0; i < 200; i += 3) kept.push_back(i);
  const auto exact = KronReduction(laplacian, kept),
             mesh = SparsifiedKronReduction(laplacian, kept, 0);
  ASSERT_TRUE(exact.ok() && mesh.ok()) << exact.status() << mesh.status();
  EXPECT_EQ(mesh->dropped_weight_fraction, 0);
  EXPECT_LT(
      (Eigen::MatrixXd(exact->laplacian) - Eigen::MatrixXd(mesh->laplacian)).cwiseAbs().maxCoeff(),
      1e-11);
}

TEST_P(KronLaws, SparsifiedStaysConnectedAndAccountsForWhatItDropped) {
  const SparseMatrix laplacian = MakeSyntheticTeam(600, GetParam()).Laplacian();
  std::vector<int> kept;
  for (int i = 0; i < 600; i += 4) kept.push_back(i);
  const auto exact = KronReduction(laplacian, kept),
             sparse = SparsifiedKronReduction(laplacian, kept, 0.01);
  ASSERT_TRUE(exact.ok() && sparse.ok()) << exact.status() << sparse.status();
  ExpectLaplacian(sparse->laplacian);
  EXPECT_LT(sparse->laplacian.nonZeros(), exact->laplacian.nonZeros() / 2);
  EXPECT_GT(sparse->dropped_weight_fraction, 0);
  EXPECT_LT(sparse->dropped_weight_fraction, 0.1);
  // Connected: one further reduction to a single pair succeeds.
  EXPECT_TRUE(KronReduction(sparse->laplacian, {0, 1}).ok());
}

INSTANTIATE_TEST_SUITE_P(Seeds, KronLaws, testing::Values(1, 2, 3));

TEST(KronReduction, RefusesAnEliminatedComponentThatReachesNoKeptNode) {
  // 0 - 1 - 2   3 - 4
  const SparseMatrix laplacian = LaplacianOfEdges(5, {{0, 1, 1}, {1, 2, 1}, {3, 4, 0.3}});
  for (const auto& reduced :
       {KronReduction(laplacian, {0, 2}), SparsifiedKronReduction(laplacian, {0, 2}, 0)}) {
    EXPECT_EQ(reduced.status().code(), absl::StatusCode::kFailedPrecondition);
    EXPECT_NE(reduced.status().message().find("node 3"), std::string::npos) << reduced.status();
  }
  EXPECT_TRUE(KronReduction(laplacian, {0, 4}).ok());
}

TEST(KronReduction, RefusesBadArguments) {
  const SparseMatrix path = PathGraphLaplacian(4);
  EXPECT_TRUE(absl::IsInvalidArgument(KronReduction(path, {}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(KronReduction(path, {0, 4}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(KronReduction(path, {-1}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(KronReduction(path, {1, 1}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(KronReduction(SparseMatrix(3, 2), {0}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(SparsifiedKronReduction(path, {0}, -1e-3).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(SparsifiedKronReduction(path, {0}, std::nan("")).status()));
  SparseMatrix broken = path;
  broken.coeffRef(0, 1) = std::nan("");
  EXPECT_TRUE(absl::IsInvalidArgument(KronReduction(broken, {0}).status()));
}

std::vector<golden::Case> AllCases() {
  std::vector<golden::Case> cases = golden::CasesIn(golden::CommittedFolder());
  for (golden::Case& shared : golden::CasesIn(golden::SharedFolder()))
    cases.push_back(std::move(shared));
  return cases;
}

TEST(KronGolden, EveryReductionAndTheGreedyOrderMatch) {
  int reductions = 0, orders = 0;
  for (const golden::Case& golden_case : AllCases()) {
    SCOPED_TRACE(golden_case.folder.string());
    const auto adjacency =
        RadiusGraphAdjacency(golden::Rigid(golden::ReadPoses(golden_case.File("poses_server.csv"))),
                             golden_case.graph_options());
    ASSERT_TRUE(adjacency.ok()) << adjacency.status();
    const SparseMatrix laplacian = GraphLaplacian(*adjacency);
    for (const char* keep :
         {"every_other", "fixed_random60", "largest_ev_80", "largest_ev_60", "largest_ev_40"}) {
      const std::string stem = std::string("kron_") + keep;
      if (!golden_case.Has(stem + "_L.csv")) continue;
      const Eigen::VectorXd column =
          golden::Table(golden_case.File(stem + "_keep.csv")).Column("node");
      const std::vector<int> kept(column.begin(), column.end());
      const auto reduced = KronReduction(laplacian, kept);
      ASSERT_TRUE(reduced.ok()) << reduced.status();
      const Eigen::MatrixXd expected = golden::ReadMatrix(golden_case.File(stem + "_L.csv"));
      EXPECT_LT((Eigen::MatrixXd(reduced->laplacian) - expected).cwiseAbs().maxCoeff(), 1e-11)
          << keep;
      ++reductions;
    }
    if (!golden_case.Has("largest_ev_order.csv")) continue;
    const golden::Table order(golden_case.File("largest_ev_order.csv"));
    NodeSelectionOptions options;
    options.rule = NodeSelectionRule::kLargestEigenvector;
    const auto ranked = RankNodes(laplacian, options);
    ASSERT_TRUE(ranked.ok()) << ranked.status();
    for (int row = 0; row < order.num_rows(); ++row) {
      if (order.Cell(row, "margin_to_next_vertex") != "nan" &&
          order.Number(row, "margin_to_next_vertex") < 1e-8)
        break;
      EXPECT_EQ((*ranked)[row], order.Integer(row, "vertex")) << "pick " << row;
    }
    ++orders;
  }
  EXPECT_GE(reductions, 5);
  EXPECT_GE(orders, 3);
}

}  // namespace
}  // namespace overtone
