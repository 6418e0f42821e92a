// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/square_root_information.h"

#include "Eigen/Cholesky"
#include "Eigen/Eigenvalues"

namespace overtone {
namespace {

// Relative to the largest entry or eigenvalue.
constexpr double kAsymmetryTolerance = 1e-6;
constexpr double kNegativeEigenvalueTolerance = 1e-9;

template <int kSize>
using Square = Eigen::Matrix<double, kSize, kSize>;

template <int kSize>
absl::StatusOr<Square<kSize>> Factorise(const Square<kSize>& information) {
  if (!information.allFinite()) {
    return absl::InvalidArgumentError("information matrix is not finite");
  }
  const double scale = information.cwiseAbs().maxCoeff();
  if ((information - information.transpose()).cwiseAbs().maxCoeff() > kAsymmetryTolerance * scale) {
    return absl::InvalidArgumentError("information matrix is not symmetric");
  }
  const Eigen::LLT<Square<kSize>> cholesky(information);
  // LLT takes a pivot that is NaN, after an overflow, for a good one.
  if (cholesky.info() == Eigen::Success && cholesky.matrixLLT().allFinite()) {
    return Square<kSize>(cholesky.matrixU());
  }
  const Eigen::SelfAdjointEigenSolver<Square<kSize>> eigen(information);
  const auto& values = eigen.eigenvalues();
  if (eigen.info() != Eigen::Success || values(0) < -kNegativeEigenvalueTolerance * scale) {
    return absl::InvalidArgumentError("information matrix is not positive semi-definite");
  }
  return Square<kSize>(values.cwiseMax(0).cwiseSqrt().asDiagonal() *
                       eigen.eigenvectors().transpose());
}

}  // namespace

absl::StatusOr<Eigen::Matrix3d> SquareRootInformation(const Eigen::Matrix3d& information) {
  return Factorise<3>(information);
}

absl::StatusOr<Matrix6d> SquareRootInformation(const Matrix6d& information) {
  return Factorise<6>(information);
}

}  // namespace overtone
