// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/kron_reduction.h"

#include <algorithm>

#include "Eigen/CholmodSupport"
#include "absl/status/status.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/spectral/graph_laplacian.h"
#include "overtone/core/spectral/kept_nodes.h"

namespace overtone {
namespace {

constexpr int kBlockColumns = 256;

// The blocks of L, rows and columns in the partition's order.
struct LaplacianBlocks {
  SparseMatrix kept_kept, kept_eliminated, eliminated_eliminated;
};

LaplacianBlocks SplitLaplacian(const SparseMatrix& laplacian, const NodePartition& partition) {
  std::vector<Eigen::Triplet<double>> kk, ke, ee;
  for (int column = 0; column < laplacian.cols(); ++column) {
    const int to = partition.position[column];
    for (SparseMatrix::InnerIterator entry(laplacian, column); entry; ++entry) {
      const int from = partition.position[entry.row()];
      if (from >= 0 && to >= 0) kk.emplace_back(from, to, entry.value());
      if (from >= 0 && to < 0) ke.emplace_back(from, -1 - to, entry.value());
      if (from < 0 && to < 0) ee.emplace_back(-1 - from, -1 - to, entry.value());
    }
  }
  const Eigen::Index k = partition.kept.size(), e = partition.eliminated.size();
  LaplacianBlocks blocks{SparseMatrix(k, k), SparseMatrix(k, e), SparseMatrix(e, e)};
  blocks.kept_kept.setFromTriplets(kk.begin(), kk.end());
  blocks.kept_eliminated.setFromTriplets(ke.begin(), ke.end());
  blocks.eliminated_eliminated.setFromTriplets(ee.begin(), ee.end());
  return blocks;
}

// -offdiag(L_kk - L_ke L_ee^-1 L_ek), not yet symmetrised or clipped; zeros are not stored.
absl::StatusOr<SparseMatrix> SchurComplementWeights(const LaplacianBlocks& blocks) {
  Eigen::CholmodSupernodalLLT<SparseMatrix, Eigen::Lower> factor;
  factor.cholmod().print = 0;
  factor.compute(blocks.eliminated_eliminated);
  if (factor.info() != Eigen::Success) {
    return absl::InternalError("Kron reduction: the factorisation of the eliminated block failed");
  }
  const Eigen::Index k = blocks.kept_kept.rows();
  const SparseMatrix eliminated_kept = blocks.kept_eliminated.transpose();
  SparseMatrix weights(k, k);
  for (Eigen::Index first = 0; first < k; first += kBlockColumns) {
    const Eigen::Index count = std::min<Eigen::Index>(kBlockColumns, k - first);
    const Eigen::MatrixXd right = eliminated_kept.middleCols(first, count);
    const Eigen::MatrixXd solved = factor.solve(right);
    const Eigen::MatrixXd fill = blocks.kept_eliminated * solved;
    for (Eigen::Index c = 0; c < count; ++c) {
      Eigen::VectorXd column = fill.col(c);
      for (SparseMatrix::InnerIterator entry(blocks.kept_kept, first + c); entry; ++entry) {
        column[entry.row()] -= entry.value();
      }
      weights.startVec(first + c);
      for (Eigen::Index row = 0; row < k; ++row) {
        if (row != first + c && column[row] != 0) weights.insertBack(row, first + c) = column[row];
      }
    }
  }
  weights.finalize();
  return weights;
}

}  // namespace

absl::StatusOr<KronReductionResult> KronReduction(const SparseMatrix& laplacian,
                                                  const std::vector<int>& kept_nodes) {
  ASSIGN_OR_RETURN(const NodePartition partition, PartitionNodes(laplacian, kept_nodes));
  const LaplacianBlocks blocks = SplitLaplacian(laplacian, partition);
  KronReductionResult result;
  if (partition.eliminated.empty()) {
    result.laplacian = blocks.kept_kept;
    return result;
  }
  ASSIGN_OR_RETURN(SparseMatrix weights, SchurComplementWeights(blocks));
  weights = 0.5 * (weights + SparseMatrix(weights.transpose()));
  if (weights.nonZeros() > 0) {
    result.largest_clipped_weight = std::max(0.0, -weights.coeffs().minCoeff());
  }
  weights.prune([](Eigen::Index, Eigen::Index, double weight) { return weight > 0; });
  result.laplacian = GraphLaplacian(weights);
  return result;
}

}  // namespace overtone
