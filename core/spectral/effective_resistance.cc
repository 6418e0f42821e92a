// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/effective_resistance.h"

#include <limits>
#include <utility>

#include "overtone/core/common/status_macros.h"
#include "overtone/core/spectral/graph_laplacian.h"

namespace overtone {
namespace {

// The connected part that each node is in, numbered from 0.
std::vector<int> Components(const SparseMatrix& laplacian) {
  std::vector<int> component(laplacian.cols(), -1);
  int count = 0;
  for (int first = 0; first < laplacian.cols(); ++first) {
    if (component[first] >= 0) continue;
    std::vector<int> waiting = {first};
    component[first] = count;
    while (!waiting.empty()) {
      const int node = waiting.back();
      waiting.pop_back();
      for (SparseMatrix::InnerIterator entry(laplacian, node); entry; ++entry) {
        const int neighbor = static_cast<int>(entry.row());
        if (component[neighbor] >= 0 || !(entry.value() < 0)) continue;
        component[neighbor] = count;
        waiting.push_back(neighbor);
      }
    }
    ++count;
  }
  return component;
}

}  // namespace

absl::StatusOr<EffectiveResistance> EffectiveResistance::Create(const SparseMatrix& laplacian) {
  RETURN_IF_ERROR(ValidateLaplacian(laplacian));
  EffectiveResistance result;
  result.component_ = Components(laplacian);
  int num_components = 0, num_rows = 0;
  for (const int component : result.component_) {
    const bool grounded = component == num_components;
    num_components += grounded;
    result.row_.push_back(grounded ? -1 : num_rows++);
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (int column = 0; column < laplacian.outerSize(); ++column) {
    for (SparseMatrix::InnerIterator entry(laplacian, column); entry; ++entry) {
      const int row = result.row_[entry.row()];
      if (row >= 0 && result.row_[column] >= 0) {
        entries.emplace_back(row, result.row_[column], entry.value());
      }
    }
  }
  SparseMatrix grounded(num_rows, num_rows);
  grounded.setFromTriplets(entries.begin(), entries.end());
  const auto factor = std::make_shared<Eigen::SimplicialLDLT<SparseMatrix>>();
  if (num_rows > 0) factor->compute(grounded);
  if (num_rows > 0 && factor->info() != Eigen::Success) {
    return absl::InternalError("effective resistance: factorisation failed");
  }
  result.factor_ = factor;
  return result;
}

double EffectiveResistance::Between(int i, int j) const {
  if (i == j) return 0;
  if (component_[i] != component_[j]) return std::numeric_limits<double>::infinity();
  const Eigen::VectorXd potentials = Potentials(i, j);
  return potentials[i] - potentials[j];
}

Eigen::VectorXd EffectiveResistance::Potentials(int i, int j) const {
  Eigen::VectorXd potentials = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(row_.size()));
  Eigen::VectorXd current = Eigen::VectorXd::Zero(factor_->rows());
  if (row_[i] >= 0) current[row_[i]] += 1;
  if (row_[j] >= 0) current[row_[j]] -= 1;
  if (current.isZero(0)) return potentials;  // i is j
  const Eigen::VectorXd solution = factor_->solve(current);
  for (size_t node = 0; node < row_.size(); ++node) {
    if (row_[node] >= 0) potentials[static_cast<Eigen::Index>(node)] = solution[row_[node]];
  }
  return potentials;
}

}  // namespace overtone
