// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/block_cholesky.h"

#include <limits>
#include <random>
#include <utility>
#include <vector>

#include "Eigen/Cholesky"
#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using Couplings = std::vector<std::pair<int, int>>;

Couplings Path(int num_blocks) {
  Couplings couplings;
  for (int i = 1; i < num_blocks; ++i) couplings.emplace_back(i - 1, i);
  return couplings;
}

// Adds the same random blocks to both; diagonally dominant, so positive definite.
void Fill(const Couplings& couplings, BlockCholesky& sparse, Eigen::MatrixXd& dense) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (int i = 0; i < dense.rows() / 6; ++i) {
    const Matrix6d block = 100 * Matrix6d::Identity();
    sparse.Add(i, i, block);
    dense.block<6, 6>(6 * i, 6 * i) += block;
  }
  for (const auto& [row, column] : couplings) {
    const Matrix6d block = Matrix6d::NullaryExpr([&] { return uniform(random); });
    sparse.Add(row, column, block);
    dense.block<6, 6>(6 * row, 6 * column) += block;
    dense.block<6, 6>(6 * column, 6 * row) += block.transpose();
  }
}

TEST(BlockCholesky, SolvesAsTheDenseFactorisationDoes) {
  constexpr int kBlocks = 30;
  std::mt19937 random(2);
  Couplings couplings = Path(kBlocks);
  for (int k = 0; k < 25; ++k) {
    const int a = random() % kBlocks, b = random() % kBlocks;
    if (a != b) couplings.emplace_back(a, b);
  }
  BlockCholesky sparse(kBlocks, couplings);
  const Eigen::VectorXd right_side = Eigen::VectorXd::LinSpaced(6 * kBlocks, -1, 2);
  for (const int round : {1, 2}) {  // a pattern serves several matrices
    sparse.SetZero();
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(6 * kBlocks, 6 * kBlocks);
    Fill(couplings, sparse, dense);
    ASSERT_TRUE(sparse.Factorise());
    const Eigen::VectorXd expected = dense.llt().solve(right_side);
    EXPECT_LT((sparse.Solve(right_side) - expected).norm(), 1e-13 * expected.norm()) << round;
  }
}

TEST(BlockCholesky, PathsAndStarsFillNothingIn) {
  EXPECT_EQ(BlockCholesky(10, Path(10)).NumNonZeros(), 10 * 21 + 9 * 36);
  Couplings star;
  for (int i = 0; i < 9; ++i) star.emplace_back(i, 9);
  EXPECT_EQ(BlockCholesky(10, star).NumNonZeros(), 10 * 21 + 9 * 36);
}

TEST(BlockCholesky, ARingNeedsOneBlockForEachNodeButThree) {
  Couplings ring = Path(10);
  ring.emplace_back(9, 0);
  EXPECT_EQ(BlockCholesky(10, ring).NumNonZeros(), 10 * 21 + (10 + 7) * 36);
}

TEST(BlockCholesky, RefusesWhatIsNotPositiveDefinite) {
  BlockCholesky matrix(2, Path(2));
  matrix.Add(0, 0, Matrix6d::Identity());
  matrix.Add(1, 1, Matrix6d::Identity());
  matrix.Add(0, 1, 2 * Matrix6d::Identity());
  EXPECT_FALSE(matrix.Factorise());
  matrix.SetZero();
  matrix.Add(0, 0, Matrix6d::Constant(std::numeric_limits<double>::quiet_NaN()));
  matrix.Add(1, 1, Matrix6d::Identity());
  EXPECT_FALSE(matrix.Factorise());
}

}  // namespace
}  // namespace overtone
