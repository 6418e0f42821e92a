// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/wavelet_transform.h"

#include <gtest/gtest.h>

#include "overtone/core/spectral/chebyshev_filter.h"
#include "overtone/core/spectral/fast_filter.h"
#include "overtone/core/spectral/graph_fourier_transform.h"
#include "overtone/core/spectral/krylov_filter.h"
#include "overtone/core/spectral/lanczos.h"
#include "overtone/tests/support/golden_case.h"
#include "overtone/tests/support/synthetic_graph.h"

namespace overtone {
namespace {

using Coefficients = std::vector<Eigen::MatrixXd>;

Coefficients Exact(const SparseMatrix& laplacian, const Eigen::MatrixXd& signals,
                   int num_scales = 6) {
  WaveletOptions options;
  options.num_scales = num_scales;
  options.method = FilterMethod::kExact;
  const auto coefficients = WaveletCoefficients(laplacian, signals, options);
  EXPECT_TRUE(coefficients.ok()) << coefficients.status();
  return *coefficients;
}

// Largest error over the largest coefficient of the same signal; the worst signal counts.
double RelativeError(const Coefficients& actual, const Coefficients& exact) {
  double worst = 0;
  for (Eigen::Index c = 0; c < exact[0].cols(); ++c) {
    double error = 0, largest = 0;
    for (size_t s = 0; s < exact.size(); ++s) {
      error = std::max(error, (actual[s].col(c) - exact[s].col(c)).cwiseAbs().maxCoeff());
      largest = std::max(largest, exact[s].col(c).cwiseAbs().maxCoeff());
    }
    worst = std::max(worst, error / largest);
  }
  return worst;
}

TEST(WaveletCoefficients, AreLinear) {
  const SyntheticTeam team = MakeSyntheticTeam(150);
  const Eigen::VectorXd f = team.DifferenceSignal(), h = team.LogDifferenceSignal().col(1);
  Eigen::MatrixXd signals(150, 3);
  signals << f, h, 2 * f - 3 * h;
  for (const Eigen::MatrixXd& w : Exact(team.Laplacian(), signals)) {
    EXPECT_LT((w.col(2) - (2 * w.col(0) - 3 * w.col(1))).norm(), 1e-10);
  }
}

// A tight frame keeps energy: sum_s |W_s|^2 = |f|^2.
TEST(WaveletCoefficients, KeepTheEnergyOfTheSignal) {
  const SyntheticTeam team = MakeSyntheticTeam(400);
  const Eigen::VectorXd f = team.DifferenceSignal();
  for (const FilterMethod method : {FilterMethod::kExact, FilterMethod::kFast}) {
    WaveletOptions options;
    options.method = method;
    const auto coefficients = WaveletCoefficients(team.Laplacian(), f, options);
    ASSERT_TRUE(coefficients.ok()) << coefficients.status();
    double energy = 0;
    for (const Eigen::MatrixXd& w : *coefficients) energy += w.squaredNorm();
    EXPECT_NEAR(energy, f.squaredNorm(), 1e-3 * f.squaredNorm());
  }
}

// A constant has frequency 0: only the scaling kernel sees it.
TEST(WaveletCoefficients, OfAConstantAreInTheScalingBandAlone) {
  const Eigen::VectorXd ones = Eigen::VectorXd::Ones(400);
  for (const FilterMethod method : {FilterMethod::kExact, FilterMethod::kFast}) {
    WaveletOptions options;
    options.method = method;
    const auto coefficients =
        WaveletCoefficients(MakeSyntheticTeam(400).Laplacian(), ones, options);
    ASSERT_TRUE(coefficients.ok()) << coefficients.status();
    EXPECT_LT(((*coefficients)[0] - ones).cwiseAbs().maxCoeff(), 1e-9);
    for (int s = 1; s < 6; ++s) EXPECT_LT((*coefficients)[s].cwiseAbs().maxCoeff(), 1e-9);
  }
}

// Every eigenvalue of a complete graph but the first is lmax: the highest band takes all but the
// mean.
TEST(WaveletCoefficients, OfACompleteGraphSplitMeanAndRest) {
  const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(10, -3, 5);
  const Coefficients w = Exact(CompleteGraphLaplacian(10), f);
  EXPECT_LT((w[0].array() - f.mean()).abs().maxCoeff(), 1e-12);
  EXPECT_LT((w[5] - (f.array() - f.mean()).matrix()).cwiseAbs().maxCoeff(), 1e-12);
  for (int s = 1; s < 5; ++s) EXPECT_LT(w[s].norm(), 1e-12);
}

// psi does not depend on how nodes are numbered.
TEST(WaveletCoefficients, FollowARenumberingOfTheNodes) {
  const SyntheticTeam team = MakeSyntheticTeam(120);
  const Eigen::VectorXd f = team.DifferenceSignal();
  Eigen::PermutationMatrix<Eigen::Dynamic> reverse(120);
  for (int i = 0; i < 120; ++i) reverse.indices()[i] = 119 - i;
  const SparseMatrix renumbered = reverse * team.Laplacian() * reverse.transpose();
  const Coefficients plain = Exact(team.Laplacian(), f), moved = Exact(renumbered, reverse * f);
  for (int s = 0; s < 6; ++s)
    EXPECT_LT((moved[s] - reverse * plain[s]).cwiseAbs().maxCoeff(), 1e-10);
}

struct FilterCase {
  int num_nodes;
  int num_scales;
  double tolerance;
};
class FastFilters : public testing::TestWithParam<FilterCase> {};

TEST_P(FastFilters, AgreeWithTheExactTransformAndEstimateTheirErrorHonestly) {
  const auto [num_nodes, num_scales, tolerance] = GetParam();
  for (const uint32_t seed : {1, 2}) {
    const SyntheticTeam team = MakeSyntheticTeam(num_nodes, seed);
    const SparseMatrix laplacian = team.Laplacian();
    Eigen::MatrixXd signals(num_nodes, 3);
    signals << team.DifferenceSignal(), team.LogDifferenceSignal().leftCols(2);
    const Coefficients exact = Exact(laplacian, signals, num_scales);
    const auto krylov =
        KrylovFilter(laplacian, signals, num_scales, tolerance, /*max_dimension=*/1000);
    const auto chebyshev = ChebyshevFilter(laplacian, signals, num_scales, tolerance);
    for (const auto& fast : {krylov, chebyshev}) {
      ASSERT_TRUE(fast.ok()) << fast.status();
      const double error = RelativeError(fast->coefficients, exact);
      EXPECT_LE(fast->error_estimate, tolerance);
      EXPECT_LT(error, tolerance) << "seed " << seed << ", order " << fast->order;
      // Round-off of the reference apart.
      EXPECT_LT(error, std::max(fast->error_estimate, 1e-10))
          << "seed " << seed << ", order " << fast->order;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, FastFilters,
                         testing::Values(FilterCase{200, 6, 1e-4}, FilterCase{500, 6, 1e-4},
                                         FilterCase{500, 9, 1e-4}, FilterCase{500, 3, 1e-6},
                                         FilterCase{400, 6, 1e-2}));

// Sixty signals, six at a time.
TEST(FastFilter, TakesManySignalsInBlocks) {
  const SparseMatrix laplacian = RandomConnectedLaplacian(60, 80, /*seed=*/4);
  const Eigen::MatrixXd impulses = Eigen::MatrixXd::Identity(60, 60);
  const auto fast = FastFilter(laplacian, impulses, 6, 1e-8);
  ASSERT_TRUE(fast.ok()) << fast.status();
  EXPECT_LT(RelativeError(fast->coefficients, Exact(laplacian, impulses)), 1e-7);
}

TEST(FastFilter, AgreesAcrossTheLineBetweenKrylovAndChebyshev) {
  const SyntheticTeam team = MakeSyntheticTeam(4000);
  const SparseMatrix laplacian = team.Laplacian();
  const Eigen::MatrixXd six = team.LogDifferenceSignal();
  const auto one = FastFilter(laplacian, six.col(0), 6, 1e-4),
             all = FastFilter(laplacian, six, 6, 1e-4);
  ASSERT_TRUE(one.ok() && all.ok()) << one.status() << all.status();
  for (int s = 0; s < 6; ++s) {
    EXPECT_LT((one->coefficients[s] - all->coefficients[s].col(0)).cwiseAbs().maxCoeff(),
              2e-4 * six.col(0).cwiseAbs().maxCoeff());
  }
}

// From 2,000 nodes on the basis is kept in single precision, unless the tolerance asks for more.
TEST(KrylovFilter, SinglePrecisionIsEnoughForItsTolerance) {
  const SyntheticTeam team = MakeSyntheticTeam(2500);
  const SparseMatrix laplacian = team.Laplacian();
  const Eigen::VectorXd signal = team.DifferenceSignal();
  const auto reference = KrylovFilter(laplacian, signal, 6, 1e-8, 1000);
  const auto compact = KrylovFilter(laplacian, signal, 6, 1e-4, 600);
  ASSERT_TRUE(reference.ok() && compact.ok()) << reference.status() << compact.status();
  EXPECT_LT(compact->order, reference->order);
  EXPECT_LT(RelativeError(compact->coefficients, reference->coefficients), 1e-4);
}

TEST(FastFilter, AKnownLmaxNeedNotBeFound) {
  for (const int num_signals : {1, 6}) {  // by Krylov, by Chebyshev
    const SyntheticTeam team = MakeSyntheticTeam(3500);
    const SparseMatrix laplacian = team.Laplacian();
    const Eigen::MatrixXd signals = team.LogDifferenceSignal().leftCols(num_signals);
    const auto searched = FastFilter(laplacian, signals, 6, 1e-4);
    ASSERT_TRUE(searched.ok()) << searched.status();
    const auto known = FastFilter(laplacian, signals, 6, 1e-4, searched->lmax);
    ASSERT_TRUE(known.ok()) << known.status();
    EXPECT_EQ(known->lmax, searched->lmax);
    EXPECT_LT(RelativeError(known->coefficients, searched->coefficients), 2e-4);
  }
}

// Large degrees: the tridiagonal eigensolver once gave up on such scales.
TEST(KrylovFilter, ConvergesOnGraphsOfEveryScale) {
  const SyntheticTeam team = MakeSyntheticTeam(2000);
  for (const double scale : {1e-6, 1.0, 3.0, 1e3, 1e6}) {
    const SparseMatrix laplacian = scale * team.Laplacian();
    const auto filtered = KrylovFilter(laplacian, team.DifferenceSignal(), 6, 1e-4, 600);
    EXPECT_TRUE(filtered.ok()) << "scale " << scale << ": " << filtered.status();
  }
}

TEST(FastFilter, HandlesDisconnectedGraphsIsolatedNodesAndZeroSignals) {
  // Two paths and an isolated node; signals: 0, an impulse on the isolated node, one on the first
  // path.
  std::vector<WeightedEdge> edges;
  for (int i = 0; i < 40; ++i) edges.push_back({i, i + 1, 1});
  for (int i = 41; i < 80; ++i) edges.push_back({i, i + 1, 0.5});
  const SparseMatrix laplacian = LaplacianOfEdges(82, edges);
  Eigen::MatrixXd signals = Eigen::MatrixXd::Zero(82, 3);
  signals(81, 1) = 2;
  signals(7, 2) = 1;
  const auto fast = FastFilter(laplacian, signals, 6, 1e-6);
  ASSERT_TRUE(fast.ok()) << fast.status();
  const Coefficients exact = Exact(laplacian, signals);
  for (int s = 0; s < 6; ++s) {
    EXPECT_LT((fast->coefficients[s] - exact[s]).cwiseAbs().maxCoeff(), 1e-5);
    EXPECT_EQ(fast->coefficients[s].col(0).norm(), 0);
    EXPECT_EQ(fast->coefficients[s](81, 2), 0);
  }
  EXPECT_NEAR(fast->coefficients[0](81, 1), 2, 1e-12);
}

TEST(FastFilter, WithoutEdgesLeavesTheSignalInTheScalingBand) {
  for (const int n : {1, 5}) {
    const SparseMatrix laplacian = LaplacianOfEdges(n, {});
    const Eigen::VectorXd f = Eigen::VectorXd::LinSpaced(n, 1, 2);
    for (const auto& result :
         {KrylovFilter(laplacian, f, 6, 1e-4, 100), ChebyshevFilter(laplacian, f, 6, 1e-4)}) {
      ASSERT_TRUE(result.ok()) << result.status();
      EXPECT_LT((result->coefficients[0] - f).norm(), 1e-15);
      for (int s = 1; s < 6; ++s) EXPECT_EQ(result->coefficients[s].norm(), 0);
    }
    EXPECT_LT((Exact(laplacian, f)[0] - f).norm(), 1e-15);
  }
}

TEST(WaveletCoefficients, OfAnEmptyGraphAreEmpty) {
  for (const FilterMethod method : {FilterMethod::kExact, FilterMethod::kFast}) {
    WaveletOptions options;
    options.method = method;
    const auto coefficients =
        WaveletCoefficients(SparseMatrix(0, 0), Eigen::MatrixXd(0, 1), options);
    ASSERT_TRUE(coefficients.ok()) << coefficients.status();
    EXPECT_EQ(coefficients->size(), 6);
    EXPECT_EQ((*coefficients)[5].rows(), 0);
  }
}

TEST(WaveletCoefficients, RefuseBadArguments) {
  const SparseMatrix path = PathGraphLaplacian(4);
  const Eigen::VectorXd f = Eigen::VectorXd::Ones(4);
  EXPECT_TRUE(WaveletOptions().Validate().ok());
  EXPECT_TRUE(
      absl::IsInvalidArgument(WaveletCoefficients(path, Eigen::VectorXd::Ones(5), {}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(WaveletCoefficients(path, f * std::nan(""), {}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(WaveletCoefficients(-path, f, {}).status()));
  for (const int scales : {2, 10}) {
    WaveletOptions options;
    options.num_scales = scales;
    EXPECT_TRUE(absl::IsInvalidArgument(WaveletCoefficients(path, f, options).status()));
  }
  WaveletOptions options;
  options.tolerance = 0;
  EXPECT_TRUE(absl::IsInvalidArgument(WaveletCoefficients(path, f, options).status()));
}

TEST(LargestEigenvalue, IsGoodToOneInAHundredThousand) {
  EXPECT_NEAR(LargestEigenvalue(CompleteGraphLaplacian(20)), 20, 1e-9);
  EXPECT_NEAR(LargestEigenvalue(StarGraphLaplacian(20)), 20, 1e-9);
  EXPECT_NEAR(LargestEigenvalue(PathGraphLaplacian(30)), 2 - 2 * std::cos(M_PI * 29 / 30), 1e-6);
  EXPECT_EQ(LargestEigenvalue(LaplacianOfEdges(3, {})), 0);
  EXPECT_EQ(LargestEigenvalue(SparseMatrix(0, 0)), 0);
  for (const uint32_t seed : {1, 2, 3}) {
    const SparseMatrix laplacian = MakeSyntheticTeam(400, seed).Laplacian();
    const double exact = GraphFourierTransform(laplacian)->largest_eigenvalue();
    EXPECT_NEAR(LargestEigenvalue(laplacian), exact, 1e-6 * exact) << "seed " << seed;
  }
}

TEST(ChebyshevGolden, CoefficientsAndFilteredSignalsMatch) {
  int checked = 0;
  std::vector<golden::Case> cases = golden::CasesIn(golden::CommittedFolder());
  for (golden::Case& shared : golden::CasesIn(golden::SharedFolder()))
    cases.push_back(std::move(shared));
  for (const golden::Case& golden_case : cases) {
    for (const int scales : {6, 9}) {
      for (const int order : {30, 50}) {
        const std::string suffix = std::to_string(scales) + "_o" + std::to_string(order) + ".csv";
        if (!golden_case.Has("cheby_coeff_s" + suffix)) continue;
        SCOPED_TRACE(golden_case.folder.string() + " s" + suffix);
        const Eigen::MatrixXd expected =
            golden::ReadMatrix(golden_case.File("cheby_coeff_s" + suffix));
        const MeyerFilterBank bank(golden_case.lmax(), scales);
        const Eigen::MatrixXd coefficients = ChebyshevCoefficients(bank, order, order + 1);
        EXPECT_LT((coefficients - expected).cwiseAbs().maxCoeff(), 1e-12);

        const auto adjacency = RadiusGraphAdjacency(
            golden::Rigid(golden::ReadPoses(golden_case.File("poses_server.csv"))),
            golden_case.graph_options());
        ASSERT_TRUE(adjacency.ok()) << adjacency.status();
        const Eigen::VectorXd signal =
            golden::Table(golden_case.File("signals.csv")).Column("f_server");
        const Coefficients filtered =
            ChebyshevSum(GraphLaplacian(*adjacency), golden_case.lmax(), coefficients, signal);
        const golden::Table table(golden_case.File("cheby_filtered_s" + suffix));
        for (int s = 0; s < scales; ++s) {
          const Eigen::VectorXd column = table.Column("W_server_" + std::to_string(s));
          EXPECT_LT((filtered[s] - column).cwiseAbs().maxCoeff(),
                    1e-11 * (1 + column.cwiseAbs().maxCoeff()));
        }
        ++checked;
      }
    }
  }
  EXPECT_GE(checked, 4);
}

}  // namespace
}  // namespace overtone
