// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/geometry/positive_definite.h"

#include <cmath>

#include "Eigen/Core"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using Eigen::Matrix3d;

TEST(PositiveDefinite, AllEigenvaluesAreAboveZero) {
  EXPECT_TRUE(IsPositiveDefinite(Matrix3d(Matrix3d::Identity())));
  EXPECT_TRUE(IsPositiveDefinite(Eigen::MatrixXd(1e-300 * Matrix3d::Identity())));
  EXPECT_FALSE(IsPositiveDefinite(Matrix3d(Matrix3d::Zero())));
  EXPECT_FALSE(IsPositiveDefinite(Matrix3d(-Matrix3d::Identity())));
  Matrix3d correlated = Matrix3d::Identity();
  correlated(0, 1) = correlated(1, 0) = 0.9;
  EXPECT_TRUE(IsPositiveDefinite(correlated));
  correlated(0, 1) = correlated(1, 0) = 1.1;
  EXPECT_FALSE(IsPositiveDefinite(correlated));
}

TEST(PositiveDefinite, NoMatrixThatIsNotFinite) {
  for (const double bad : {NAN, INFINITY, -INFINITY}) {
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) {
        Matrix3d matrix = Matrix3d::Identity();
        matrix(row, column) = matrix(column, row) = bad;
        EXPECT_FALSE(IsPositiveDefinite(matrix)) << row << " " << column << " " << bad;
      }
    }
  }
}

// 1e306 / 1e-5 is infinite, and infinity times zero makes NaN of the last pivot.
TEST(PositiveDefinite, NoneWhoseFactorOverflows) {
  Matrix3d matrix = Matrix3d::Identity();
  matrix(0, 0) = 1e-10;
  matrix(0, 2) = matrix(2, 0) = 1e306;
  EXPECT_FALSE(IsPositiveDefinite(matrix));
}

}  // namespace
}  // namespace overtone
