// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/block_cholesky.h"

#include <algorithm>

#include "Eigen/Cholesky"
#include "Eigen/OrderingMethods"
#include "Eigen/SparseCore"

namespace overtone {
namespace {

// Approximate minimum degree: block row -> place in the order of elimination.
std::vector<int> EliminationOrder(int num_blocks,
                                  const std::vector<std::pair<int, int>>& couplings) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(couplings.size() + num_blocks);
  for (const auto& [a, b] : couplings) entries.emplace_back(std::max(a, b), std::min(a, b), 1);
  for (int i = 0; i < num_blocks; ++i) entries.emplace_back(i, i, 1);
  Eigen::SparseMatrix<double> pattern(num_blocks, num_blocks);
  pattern.setFromTriplets(entries.begin(), entries.end());
  Eigen::PermutationMatrix<Eigen::Dynamic, Eigen::Dynamic, int> order;
  Eigen::AMDOrdering<int>()(pattern.selfadjointView<Eigen::Lower>(), order);
  std::vector<int> position(num_blocks);
  for (int place = 0; place < num_blocks; ++place) position[order.indices()[place]] = place;
  return position;
}

void SortUnique(std::vector<int>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

BlockCholesky::BlockCholesky(int num_blocks, const std::vector<std::pair<int, int>>& couplings)
    : position_(EliminationOrder(num_blocks, couplings)),
      below_(num_blocks),
      diagonal_(num_blocks),
      blocks_(num_blocks) {
  for (const auto& [a, b] : couplings) {
    const auto [column, row] = std::minmax(position_[a], position_[b]);
    below_[column].push_back(row);
  }
  // Eliminating a column couples all rows below it: the first of them inherits the others.
  for (int column = 0; column < num_blocks; ++column) {
    std::vector<int>& rows = below_[column];
    SortUnique(rows);
    if (rows.empty()) continue;
    std::vector<int>& heir = below_[rows.front()];
    heir.insert(heir.end(), rows.begin() + 1, rows.end());
  }
  for (int column = 0; column < num_blocks; ++column) blocks_[column].resize(below_[column].size());
}

void BlockCholesky::SetZero() {
  for (Matrix6d& block : diagonal_) block.setZero();
  for (std::vector<Matrix6d>& column : blocks_) {
    for (Matrix6d& block : column) block.setZero();
  }
}

void BlockCholesky::Add(int row, int column, const Matrix6d& block) {
  const int i = position_[row], j = position_[column];
  if (i == j) {
    diagonal_[i] += block;
    return;
  }
  const std::vector<int>& rows = below_[std::min(i, j)];
  const auto place = std::lower_bound(rows.begin(), rows.end(), std::max(i, j)) - rows.begin();
  Matrix6d& target = blocks_[std::min(i, j)][place];
  if (i > j) {
    target += block;
  } else {
    target += block.transpose();
  }
}

bool BlockCholesky::Factorise() {
  for (int column = 0; column < size(); ++column) {
    const Eigen::LLT<Matrix6d> root(diagonal_[column]);
    if (root.info() != Eigen::Success) return false;
    diagonal_[column] = root.matrixL();
    for (Matrix6d& block : blocks_[column]) root.matrixU().solveInPlace<Eigen::OnTheRight>(block);
    Eliminate(column);
  }
  return std::all_of(diagonal_.begin(), diagonal_.end(),
                     [](const Matrix6d& block) { return block.allFinite(); });
}

// Subtracts from the rows below `column` what it explains of them.
void BlockCholesky::Eliminate(int column) {
  const std::vector<int>& rows = below_[column];
  const std::vector<Matrix6d>& factor = blocks_[column];
  for (size_t j = 0; j < rows.size(); ++j) {
    const Matrix6d transposed = factor[j].transpose();
    diagonal_[rows[j]].noalias() -= factor[j].lazyProduct(transposed);
    const std::vector<int>& targets = below_[rows[j]];
    size_t place = 0;
    for (size_t i = j + 1; i < rows.size(); ++i, ++place) {
      while (targets[place] != rows[i]) ++place;
      blocks_[rows[j]][place].noalias() -= factor[i].lazyProduct(transposed);
    }
  }
}

Eigen::VectorXd BlockCholesky::Solve(const Eigen::VectorXd& right_side) const {
  Eigen::VectorXd x(right_side.size());
  for (int i = 0; i < size(); ++i) x.segment<6>(6 * position_[i]) = right_side.segment<6>(6 * i);
  for (int column = 0; column < size(); ++column) {
    auto part = x.segment<6>(6 * column);
    diagonal_[column].triangularView<Eigen::Lower>().solveInPlace(part);
    for (size_t k = 0; k < below_[column].size(); ++k) {
      x.segment<6>(6 * below_[column][k]).noalias() -= blocks_[column][k] * part;
    }
  }
  for (int column = size() - 1; column >= 0; --column) {
    auto part = x.segment<6>(6 * column);
    for (size_t k = 0; k < below_[column].size(); ++k) {
      part.noalias() -= blocks_[column][k].transpose() * x.segment<6>(6 * below_[column][k]);
    }
    diagonal_[column].transpose().triangularView<Eigen::Upper>().solveInPlace(part);
  }
  Eigen::VectorXd solution(right_side.size());
  for (int i = 0; i < size(); ++i) solution.segment<6>(6 * i) = x.segment<6>(6 * position_[i]);
  return solution;
}

int64_t BlockCholesky::NumNonZeros() const {
  int64_t count = 21 * static_cast<int64_t>(diagonal_.size());
  for (const std::vector<int>& rows : below_) count += 36 * static_cast<int64_t>(rows.size());
  return count;
}

}  // namespace overtone
