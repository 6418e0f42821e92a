// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/tridiagonal_eigensystem.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "Eigen/Eigenvalues"

namespace overtone {
namespace {

struct Tridiagonal {
  std::vector<double> diagonal, subdiagonal;

  Eigen::MatrixXd Dense() const {
    const int m = static_cast<int>(diagonal.size());
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(m, m);
    for (int i = 0; i < m; ++i) dense(i, i) = diagonal[i];
    for (int i = 0; i + 1 < m; ++i) dense(i, i + 1) = dense(i + 1, i) = subdiagonal[i];
    return dense;
  }
};

Tridiagonal Random(int m, double scale, uint32_t seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> entry(-scale, scale);
  Tridiagonal t;
  for (int i = 0; i < m; ++i) t.diagonal.push_back(entry(generator));
  for (int i = 0; i + 1 < m; ++i) t.subdiagonal.push_back(entry(generator));
  return t;
}

// f(T) e_1 for f(x) = 1, x and x^2 needs no eigenvectors: e_1, T e_1, T^2 e_1.
TEST(TridiagonalEigensystem, AppliesPolynomialsAsTheMatrixDoes) {
  for (const int m : {1, 2, 3, 50, 300}) {
    for (const double scale : {1e-8, 1.0, 1e8}) {
      const Tridiagonal t = Random(m, scale, /*seed=*/m);
      const TridiagonalEigensystem system(t.diagonal, t.subdiagonal);
      ASSERT_TRUE(system.ok());
      const Eigen::VectorXd lambda = system.eigenvalues() / scale;
      Eigen::MatrixXd values(m, 3);
      values << Eigen::VectorXd::Ones(m), lambda, lambda.cwiseAbs2();
      const Eigen::MatrixXd dense = t.Dense() / scale;
      Eigen::MatrixXd expected(m, 3);
      expected.col(0) = Eigen::VectorXd::Unit(m, 0);
      expected.col(1) = dense * expected.col(0);
      expected.col(2) = dense * expected.col(1);
      EXPECT_LT((system.FunctionsTimesFirstUnit(values) - expected).norm(), 1e-12)
          << "m " << m << ", scale " << scale;
    }
  }
}

// The second difference with fixed ends: 2 - 2 cos(k pi / (m + 1)).
TEST(TridiagonalEigensystem, FindsTheSpectrumOfTheSecondDifference) {
  constexpr int kSize = 40;
  const std::vector<double> diagonal(kSize, 2), subdiagonal(kSize - 1, -1);
  const TridiagonalEigensystem system(diagonal, subdiagonal);
  ASSERT_TRUE(system.ok());
  Eigen::VectorXd eigenvalues = system.eigenvalues();
  std::sort(eigenvalues.begin(), eigenvalues.end());
  for (int k = 1; k <= kSize; ++k) {
    EXPECT_NEAR(eigenvalues[k - 1], 2 - 2 * std::cos(k * M_PI / (kSize + 1)), 1e-13);
  }
  EXPECT_NEAR(LargestTridiagonalEigenvalue(diagonal, subdiagonal), eigenvalues[kSize - 1], 1e-13);
}

TEST(TridiagonalEigensystem, TakesDecoupledBlocksAndZero) {
  const TridiagonalEigensystem zero({0, 0, 0}, {0, 0});
  ASSERT_TRUE(zero.ok());
  EXPECT_EQ(zero.eigenvalues().norm(), 0);
  const TridiagonalEigensystem blocks({0, 0, 5}, {1, 0});
  ASSERT_TRUE(blocks.ok());
  EXPECT_NEAR(blocks.eigenvalues().sum(), 5, 1e-14);
  EXPECT_NEAR(blocks.eigenvalues().minCoeff(), -1, 1e-14);
  EXPECT_EQ(LargestTridiagonalEigenvalue({0, 0, 0}, {0, 0}), 0);
  EXPECT_NEAR(LargestTridiagonalEigenvalue({0, 0, 5}, {1, 0}), 5, 1e-13);
  EXPECT_NEAR(LargestTridiagonalEigenvalue({-3}, {}), -3, 1e-13);
}

TEST(TridiagonalEigensystem, GivesUpOnWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(TridiagonalEigensystem({1, 2, 3}, {nan, 1}).ok());
}

TEST(LargestTridiagonalEigenvalue, AgreesWithTheDenseSolver) {
  for (const uint32_t seed : {1, 2, 3, 4}) {
    const Tridiagonal t = Random(60, 1, seed);
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> dense(t.Dense(), Eigen::EigenvaluesOnly);
    EXPECT_NEAR(LargestTridiagonalEigenvalue(t.diagonal, t.subdiagonal),
                dense.eigenvalues().maxCoeff(), 1e-12)
        << "seed " << seed;
  }
}

}  // namespace
}  // namespace overtone
