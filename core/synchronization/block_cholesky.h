// SPDX-License-Identifier: Apache-2.0
// Sparse Cholesky factorisation of a symmetric positive definite matrix of 6 x 6 blocks, one block
// row for each pose. The order of elimination and the fill are found once for a pattern, which
// Gauss-Newton then factorises at every step.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_BLOCK_CHOLESKY_H_
#define OVERTONE_CORE_SYNCHRONIZATION_BLOCK_CHOLESKY_H_

#include <cstdint>
#include <utility>
#include <vector>

#include "Eigen/Core"
#include "overtone/core/geometry/se3.h"

namespace overtone {

class BlockCholesky {
 public:
  // couplings: pairs of different block rows in [0, num_blocks), in any order, repeated or not.
  BlockCholesky(int num_blocks, const std::vector<std::pair<int, int>>& couplings);

  void SetZero();
  // Adds to the block at (row, column), and its transpose at (column, row). Diagonal blocks must be
  // symmetric; the others must be among the couplings.
  void Add(int row, int column, const Matrix6d& block);

  // Replaces the matrix by its factor. False: not positive definite, or not finite.
  bool Factorise();
  // right_side: 6 num_blocks. After Factorise.
  Eigen::VectorXd Solve(const Eigen::VectorXd& right_side) const;

  // Of the factor; a diagonal block counts 21.
  int64_t NumNonZeros() const;

 private:
  int size() const { return static_cast<int>(diagonal_.size()); }
  void Eliminate(int column);

  // Everything below goes by the order of elimination.
  std::vector<int> position_;  // block row as given -> place in the order
  std::vector<std::vector<int>>
      below_;  // per column: rows of the blocks below the diagonal, sorted
  std::vector<Matrix6d> diagonal_;
  std::vector<std::vector<Matrix6d>> blocks_;  // per column, beside below_
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_BLOCK_CHOLESKY_H_
