// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/graph_laplacian.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "absl/strings/str_cat.h"

namespace overtone {

SparseMatrix GraphLaplacian(const SparseMatrix& adjacency) {
  const int n = static_cast<int>(adjacency.rows());
  const Eigen::VectorXd degree = adjacency * Eigen::VectorXd::Ones(n);
  SparseMatrix laplacian(n, n);
  laplacian.reserve(adjacency.nonZeros() + n);
  for (int column = 0; column < n; ++column) {
    laplacian.startVec(column);
    SparseMatrix::InnerIterator entry(adjacency, column);
    for (; entry && entry.row() < column; ++entry) {
      laplacian.insertBack(entry.row(), column) = -entry.value();
    }
    laplacian.insertBack(column, column) = degree[column];
    for (; entry; ++entry) laplacian.insertBack(entry.row(), column) = -entry.value();
  }
  laplacian.finalize();
  return laplacian;
}

SparseMatrix AdjacencyFromLaplacian(const SparseMatrix& laplacian) {
  SparseMatrix adjacency = -laplacian;
  adjacency.prune([](Eigen::Index row, Eigen::Index column, double value) {
    return row != column && value > 0;
  });
  return adjacency;
}

absl::Status ValidateLaplacian(const SparseMatrix& laplacian) {
  if (laplacian.rows() != laplacian.cols()) {
    return absl::InvalidArgumentError(
        absl::StrCat("laplacian: ", laplacian.rows(), " x ", laplacian.cols(), " is not square"));
  }
  const int n = static_cast<int>(laplacian.cols());
  double largest = 0;
  for (int column = 0; column < n; ++column) {
    for (SparseMatrix::InnerIterator entry(laplacian, column); entry; ++entry) {
      if (!std::isfinite(entry.value())) {
        return absl::InvalidArgumentError(
            absl::StrCat("laplacian(", entry.row(), ", ", column, "): not finite"));
      }
      largest = std::max(largest, std::abs(entry.value()));
    }
  }
  const double tolerance = 1e-9 * largest;
  // (L - L^T) x = 0 for an x of unrelated entries finds asymmetry without a transposed copy.
  const Eigen::VectorXd probe =
      Eigen::VectorXd::NullaryExpr(n, [](Eigen::Index i) { return std::sin(1.0 + 1.7 * i); });
  const Eigen::VectorXd asymmetry = laplacian * probe - laplacian.transpose() * probe;
  const Eigen::VectorXd row_sum = laplacian.transpose() * Eigen::VectorXd::Ones(n);
  for (int column = 0; column < n; ++column) {
    if (std::abs(row_sum[column]) > tolerance) {
      return absl::InvalidArgumentError(
          absl::StrCat("laplacian: row ", column, " sums to ", row_sum[column], ", not to 0"));
    }
    if (std::abs(asymmetry[column]) > tolerance) {
      return absl::InvalidArgumentError(
          absl::StrCat("laplacian: row ", column, " is not symmetric"));
    }
    for (SparseMatrix::InnerIterator entry(laplacian, column); entry; ++entry) {
      if (entry.row() != column && entry.value() > tolerance) {
        return absl::InvalidArgumentError(
            absl::StrCat("laplacian(", entry.row(), ", ", column, "): a negative weight"));
      }
    }
  }
  return absl::OkStatus();
}

}  // namespace overtone
