// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/relative_pose_error.h"

#include <limits>

#include "gtest/gtest.h"
#include "overtone/core/estimation/square_root_information.h"
#include "overtone/tests/core/estimation/pose_graph_test_support.h"

namespace overtone {
namespace {

Vector6d Residual(const RelativePoseError& error, const Rigid3d& i, const Rigid3d& j) {
  double block_i[kPoseBlockSize], block_j[kPoseBlockSize];
  WritePoseBlock(i, block_i);
  WritePoseBlock(j, block_j);
  const double* blocks[] = {block_i, block_j};
  Vector6d residual;
  EXPECT_TRUE(error.Evaluate(blocks, residual.data(), nullptr));
  return residual;
}

// With a diagonal matrix L and L^T are alike; only a full one shows which of them weights the
// residual.
TEST(SquareRootInformation, WeightsTheErrorByTheFullInformationMatrix) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 20; ++trial) {
    const Matrix6d information = RandomInformation(random);
    const auto root = SquareRootInformation(information);
    ASSERT_TRUE(root.ok()) << root.status();
    const Vector6d e = RandomVector(random, 1);
    EXPECT_NEAR((*root * e).squaredNorm(), e.dot(information * e), 1e-9 * e.dot(information * e));
  }
}

TEST(SquareRootInformation, TakesSemiDefiniteMatrices) {
  Vector6d diagonal;
  diagonal << 4, 9, 0, 0, 0, 1;
  const Matrix6d information = diagonal.asDiagonal();
  const auto root = SquareRootInformation(information);
  ASSERT_TRUE(root.ok()) << root.status();
  EXPECT_LT((root->transpose() * *root - information).norm(), 1e-12);
}

TEST(SquareRootInformation, RefusesWhatIsNoInformation) {
  Matrix6d matrix = Matrix6d::Identity();
  matrix(3, 3) = -1e-3;
  EXPECT_EQ(SquareRootInformation(matrix).status().message(),
            "information matrix is not positive semi-definite");
  matrix = Matrix6d::Identity();
  matrix(0, 1) = 0.5;
  EXPECT_EQ(SquareRootInformation(matrix).status().message(),
            "information matrix is not symmetric");
  matrix(0, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(SquareRootInformation(matrix).status().message(), "information matrix is not finite");
}

TEST(RelativePoseError, IsZeroAtTheMeasurement) {
  std::mt19937 random(2);
  const Rigid3d i = RandomPose(random), j = RandomPose(random);
  const RelativePoseError error(i.Inverse() * j, Matrix6d::Identity());
  EXPECT_LT(Residual(error, i, j).norm(), 1e-12);
}

TEST(RelativePoseError, IsTheWeightedRightTangentOfTheMeasurement) {
  std::mt19937 random(3);
  const Rigid3d i = RandomPose(random), i_from_j = RandomPose(random);
  const Vector6d e = RandomVector(random, 0.3);
  const Matrix6d information = RandomInformation(random);
  const RelativePoseError error(i_from_j, *SquareRootInformation(information));
  const Rigid3d j = i * i_from_j * Exp(e);
  EXPECT_NEAR(error.ChiSquare(i, j), e.dot(information * e), 1e-9);
  EXPECT_NEAR(Residual(error, i, j).squaredNorm(), e.dot(information * e), 1e-9);
}

// Central differences along the manifold against the analytic Jacobians, far from and near the
// measurement.
TEST(RelativePoseError, JacobiansAreTheDerivativesAlongThePerturbations) {
  std::mt19937 random(4);
  const PoseManifold manifold;
  for (const double misfit : {0.0, 1e-6, 0.1, 1.0}) {
    const Rigid3d poses[] = {RandomPose(random), RandomPose(random)};
    const Rigid3d measured = poses[0].Inverse() * poses[1] * Exp(RandomVector(random, misfit));
    const RelativePoseError error(measured, *SquareRootInformation(RandomInformation(random)));
    double blocks[2][kPoseBlockSize];
    for (int end : {0, 1}) WritePoseBlock(poses[end], blocks[end]);
    const double* parameters[] = {blocks[0], blocks[1]};
    Eigen::Matrix<double, 6, kPoseBlockSize, Eigen::RowMajor> lifted[2];
    double* jacobians[] = {lifted[0].data(), lifted[1].data()};
    Vector6d residual;
    ASSERT_TRUE(error.Evaluate(parameters, residual.data(), jacobians));
    for (int end : {0, 1}) {
      Eigen::Matrix<double, kPoseBlockSize, 6, Eigen::RowMajor> plus;
      manifold.PlusJacobian(blocks[end], plus.data());
      const Matrix6d analytic = lifted[end] * plus;
      Matrix6d numeric;
      constexpr double kStep = 1e-6;
      for (int k = 0; k < 6; ++k) {
        Rigid3d moved[2][2] = {{poses[0], poses[1]}, {poses[0], poses[1]}};
        moved[0][end] = poses[end] * Exp(kStep * Vector6d::Unit(k));
        moved[1][end] = poses[end] * Exp(-kStep * Vector6d::Unit(k));
        numeric.col(k) = (Residual(error, moved[0][0], moved[0][1]) -
                          Residual(error, moved[1][0], moved[1][1])) /
                         (2 * kStep);
      }
      EXPECT_LT((analytic - numeric).norm(), 1e-7 * (1 + numeric.norm()))
          << "end " << end << ", misfit " << misfit;
    }
  }
}

TEST(PoseManifold, MinusUndoesPlus) {
  std::mt19937 random(5);
  const PoseManifold manifold;
  double x[kPoseBlockSize], moved[kPoseBlockSize];
  WritePoseBlock(RandomPose(random), x);
  const Vector6d delta = RandomVector(random, 0.5);
  Vector6d back;
  manifold.Plus(x, delta.data(), moved);
  manifold.Minus(moved, x, back.data());
  EXPECT_LT((back - delta).norm(), 1e-12);
}

}  // namespace
}  // namespace overtone
