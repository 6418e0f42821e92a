// SPDX-License-Identifier: Apache-2.0
// Every golden case, from poses to wavelet coefficients, at the tolerances of tests/data/README.md.
#include <gtest/gtest.h>

#include "overtone/core/spectral/edge_weights.h"
#include "overtone/core/spectral/graph_fourier_transform.h"
#include "overtone/core/spectral/graph_laplacian.h"
#include "overtone/core/spectral/meyer_wavelets.h"
#include "overtone/core/spectral/wavelet_transform.h"
#include "overtone/tests/support/golden_case.h"

namespace overtone {
namespace {

using golden::Case;
using golden::Table;

std::vector<Case> AllCases() {
  std::vector<Case> cases = golden::CasesIn(golden::CommittedFolder());
  for (Case& shared : golden::CasesIn(golden::SharedFolder())) cases.push_back(std::move(shared));
  return cases;
}

class GoldenCase : public testing::TestWithParam<Case> {
 protected:
  std::vector<Rigid3d> Poses(const std::string& file) const {
    return golden::Rigid(golden::ReadPoses(GetParam().File(file)));
  }
  SparseMatrix Laplacian() const {
    const auto adjacency =
        RadiusGraphAdjacency(Poses("poses_server.csv"), GetParam().graph_options());
    EXPECT_TRUE(adjacency.ok()) << adjacency.status();
    return GraphLaplacian(*adjacency);
  }
  // The distance from the first pose to each pose.
  Eigen::VectorXd Signal(const std::string& file, DistanceMetric metric,
                         const MetricWeights& weights) const {
    const std::vector<Rigid3d> poses = Poses(file);
    Eigen::VectorXd signal(poses.size());
    for (size_t i = 0; i < poses.size(); ++i) {
      signal[i] = PoseDistance(poses[0], poses[i], metric, weights);
    }
    return signal;
  }
  Eigen::VectorXd CaseSignal(const std::string& file) const {
    return Signal(file, GetParam().graph_options().metric, PrototypeSignalWeights());
  }
  // The numbers of scales for which the case has `stem<scales>.csv`.
  std::vector<int> ScalesWith(const std::string& stem) const {
    std::vector<int> found;
    for (int scales = 3; scales <= 9; ++scales) {
      if (GetParam().Has(stem + std::to_string(scales) + ".csv")) found.push_back(scales);
    }
    return found;
  }
};

void ExpectClose(const Eigen::VectorXd& actual, const Eigen::VectorXd& expected, double tolerance) {
  ASSERT_EQ(actual.size(), expected.size());
  for (Eigen::Index i = 0; i < actual.size(); ++i) {
    EXPECT_NEAR(actual[i], expected[i], tolerance * (1 + std::abs(expected[i]))) << "entry " << i;
  }
}

TEST_P(GoldenCase, AdjacencyHasTheSameEdgesAndWeights) {
  const auto adjacency =
      RadiusGraphAdjacency(Poses("poses_server.csv"), GetParam().graph_options());
  ASSERT_TRUE(adjacency.ok()) << adjacency.status();
  const Table edges(GetParam().File("adjacency.csv"));
  ASSERT_EQ(adjacency->nonZeros(), 2 * edges.num_rows());
  for (int row = 0; row < edges.num_rows(); ++row) {
    const int i = edges.Integer(row, "i"), j = edges.Integer(row, "j");
    EXPECT_NEAR(adjacency->coeff(i, j), edges.Number(row, "w"), 1e-12) << i << ", " << j;
    EXPECT_EQ(adjacency->coeff(i, j), adjacency->coeff(j, i)) << i << ", " << j;
  }
}

TEST_P(GoldenCase, LaplacianMatches) {
  const SparseMatrix laplacian = Laplacian();
  const Table entries(GetParam().File("laplacian.csv"));
  for (int row = 0; row < entries.num_rows(); ++row) {
    const int i = entries.Integer(row, "i"), j = entries.Integer(row, "j");
    EXPECT_NEAR(laplacian.coeff(i, j), entries.Number(row, "L_ij"), 1e-12) << i << ", " << j;
  }
}

TEST_P(GoldenCase, EigenvaluesMatch) {
  const auto spectrum = GraphFourierTransform(Laplacian());
  ASSERT_TRUE(spectrum.ok()) << spectrum.status();
  const Eigen::VectorXd expected = Table(GetParam().File("eigenvalues.csv")).Column("lambda");
  ASSERT_EQ(spectrum->eigenvalues.size(), expected.size());
  EXPECT_EQ(spectrum->eigenvalues[0], 0);
  EXPECT_LT((spectrum->eigenvalues - expected).cwiseAbs().maxCoeff(), 1e-11 * GetParam().lmax());
}

TEST_P(GoldenCase, KernelsMatchOnTheGridAndAtTheEigenvalues) {
  for (const char* stem : {"kernel_grid_s", "kernel_eig_s"}) {
    for (const int scales : ScalesWith(stem)) {
      const Table table(GetParam().File(stem + std::to_string(scales) + ".csv"));
      const MeyerFilterBank bank(GetParam().lmax(), scales);
      const Eigen::MatrixXd kernels = bank.Evaluate(table.Column("lambda")).transpose();
      EXPECT_LT((kernels - table.Columns("g")).cwiseAbs().maxCoeff(), 1e-13) << stem << scales;
    }
  }
}

// Column m of psi_s is the filtered unit impulse at m.
TEST_P(GoldenCase, WaveletsMatch) {
  for (const int scales : ScalesWith("psi_s")) {
    const Table table(GetParam().File("psi_s" + std::to_string(scales) + ".csv"));
    const Eigen::MatrixXd expected = table.Columns("psi");
    WaveletOptions options;
    options.num_scales = scales;
    options.method = FilterMethod::kExact;
    const int n = GetParam().num_nodes();
    const auto psi = WaveletCoefficients(Laplacian(), Eigen::MatrixXd::Identity(n, n), options);
    ASSERT_TRUE(psi.ok()) << psi.status();
    for (int row = 0; row < table.num_rows(); ++row) {
      for (int s = 0; s < scales; ++s) {
        EXPECT_NEAR((*psi)[s](table.Integer(row, "n"), table.Integer(row, "m")), expected(row, s),
                    1e-11);
      }
    }
  }
}

TEST_P(GoldenCase, SignalsMatch) {
  const Table table(GetParam().File("signals.csv"));
  const struct {
    const char* poses;
    const char* column;
  } signals[] = {{"poses_server.csv", "f_server"}, {"poses_robot.csv", "h_robot"}};
  for (const auto& [poses, column] : signals) {
    ExpectClose(CaseSignal(poses), table.Column(column), 1e-12);
    ExpectClose(Signal(poses, DistanceMetric::kSe3, MetricWeights()),
                table.Column(std::string(column) + "_Midentity"), 1e-12);
  }
}

TEST_P(GoldenCase, CoefficientsMatch) {
  Eigen::MatrixXd signals(GetParam().num_nodes(), 2);
  signals << CaseSignal("poses_server.csv"), CaseSignal("poses_robot.csv");
  for (const int scales : ScalesWith("coeffs_s")) {
    WaveletOptions options;
    options.num_scales = scales;
    options.method = FilterMethod::kExact;
    const auto coefficients = WaveletCoefficients(Laplacian(), signals, options);
    ASSERT_TRUE(coefficients.ok()) << coefficients.status();
    const Table table(GetParam().File("coeffs_s" + std::to_string(scales) + ".csv"));
    for (int s = 0; s < scales; ++s) {
      ExpectClose((*coefficients)[s].col(0), table.Column("W_server_" + std::to_string(s)), 1e-10);
      ExpectClose((*coefficients)[s].col(1), table.Column("W_robot_" + std::to_string(s)), 1e-10);
    }
  }
}

// The transform of the difference, summed over thirds of the scales, is the difference's band
// table.
TEST_P(GoldenCase, FeaturesMatch) {
  const Eigen::VectorXd difference = CaseSignal("poses_server.csv") - CaseSignal("poses_robot.csv");
  for (const int scales : ScalesWith("features_s")) {
    WaveletOptions options;
    options.num_scales = scales;
    options.method = FilterMethod::kExact;
    const auto coefficients = WaveletCoefficients(Laplacian(), difference, options);
    ASSERT_TRUE(coefficients.ok()) << coefficients.status();
    Eigen::MatrixXd bands = Eigen::MatrixXd::Zero(difference.size(), 3);
    for (int s = 0; s < scales; ++s) bands.col(3 * s / scales) += (*coefficients)[s].cwiseAbs();
    const Table table(GetParam().File("features_s" + std::to_string(scales) + ".csv"));
    ExpectClose(bands.col(0), table.Column("low"), 1e-10);
    ExpectClose(bands.col(1), table.Column("mid"), 1e-10);
    ExpectClose(bands.col(2), table.Column("high"), 1e-10);
  }
}

std::string CaseName(const testing::TestParamInfo<Case>& info) {
  const bool committed = info.param.folder.parent_path() == golden::CommittedFolder();
  return (committed ? "Committed_" : "Shared_") + info.param.name();
}
INSTANTIATE_TEST_SUITE_P(Cases, GoldenCase, testing::ValuesIn(AllCases()), CaseName);

TEST(GoldenFolder, CasesAreInTheTree) {
  EXPECT_EQ(golden::CasesIn(golden::CommittedFolder()).size(), 3);
}

TEST(GoldenFolder, FurtherCasesAreReadFromTheSharedFolder) {
  if (golden::CasesIn(golden::SharedFolder()).empty()) {
    GTEST_SKIP() << "no cases in " << golden::SharedFolder() << "; set OVERTONE_TEST_GOLDEN_DIR";
  }
}

}  // namespace
}  // namespace overtone
