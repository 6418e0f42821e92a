// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/reduction_node_selection.h"

#include <algorithm>
#include <numeric>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/spectral/graph_fourier_transform.h"
#include "overtone/core/spectral/graph_laplacian.h"

namespace overtone {
namespace {

constexpr int kBlock = 10;

std::vector<int> ByDecreasing(const Eigen::VectorXd& score) {
  std::vector<int> order(score.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return score[a] > score[b]; });
  return order;
}

// A node's score is its rank within its block: all blocks' first ones, then all blocks' second
// ones, ...
std::vector<int> RankByLocalDegree(const Eigen::VectorXd& degree) {
  const Eigen::Index n = degree.size();
  Eigen::VectorXd score(n);
  for (Eigen::Index first = 0; first < n; first += kBlock) {
    const Eigen::Index count = std::min<Eigen::Index>(kBlock, n - first);
    const std::vector<int> order = ByDecreasing(degree.segment(first, count));
    for (Eigen::Index rank = 0; rank < count; ++rank) {
      score[first + order[rank]] = -static_cast<double>(rank) / count;
    }
  }
  // Equal ranks: the largest degree first.
  std::vector<int> order = ByDecreasing(degree);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return score[a] > score[b]; });
  return order;
}

// The number of each node's connected component.
std::vector<int> ConnectedComponents(const SparseMatrix& laplacian) {
  std::vector<int> component(laplacian.cols(), -1);
  int count = 0;
  for (int start = 0; start < laplacian.cols(); ++start) {
    if (component[start] >= 0) continue;
    component[start] = count;
    std::vector<int> frontier = {start};
    while (!frontier.empty()) {
      const int node = frontier.back();
      frontier.pop_back();
      for (SparseMatrix::InnerIterator entry(laplacian, node); entry; ++entry) {
        if (entry.value() < 0 && component[entry.row()] < 0) {
          component[entry.row()] = count;
          frontier.push_back(static_cast<int>(entry.row()));
        }
      }
    }
    ++count;
  }
  return component;
}

}  // namespace

absl::StatusOr<std::vector<int>> RankNodes(const SparseMatrix& laplacian,
                                           const NodeSelectionOptions& options) {
  RETURN_IF_ERROR(ValidateLaplacian(laplacian));
  const bool by_eigenvectors = options.rule == NodeSelectionRule::kLargestEigenvector ||
                               (options.rule == NodeSelectionRule::kAuto &&
                                laplacian.rows() <= options.eigenvectors_up_to_nodes);
  if (!by_eigenvectors) return RankByLocalDegree(laplacian.diagonal());
  // Taking the largest entry of |U|, then the largest outside its row, and so on, visits the rows
  // in this order.
  ASSIGN_OR_RETURN(const GraphSpectrum spectrum, GraphFourierTransform(laplacian));
  return ByDecreasing(spectrum.eigenvectors.cwiseAbs().rowwise().maxCoeff());
}

absl::StatusOr<std::vector<int>> SelectNodes(const SparseMatrix& laplacian, int num_kept,
                                             const std::vector<int>& always_keep,
                                             const NodeSelectionOptions& options) {
  const int n = static_cast<int>(laplacian.rows());
  if (num_kept < 1 || num_kept > n) {
    return absl::InvalidArgumentError(
        absl::StrCat("num_kept: ", num_kept, " is not in [1, ", n, "]"));
  }
  ASSIGN_OR_RETURN(const std::vector<int> ranked, RankNodes(laplacian, options));
  std::vector<bool> kept(n, false);
  int count = 0;
  const auto keep = [&](int node) {
    if (!kept[node]) ++count;
    kept[node] = true;
  };
  for (const int node : always_keep) {
    if (node < 0 || node >= n) {
      return absl::InvalidArgumentError(
          absl::StrCat("always_keep: ", node, " is not in [0, ", n, ")"));
    }
    keep(node);
  }
  for (size_t i = 0; i < ranked.size() && count < num_kept; ++i) keep(ranked[i]);

  const std::vector<int> component = ConnectedComponents(laplacian);
  std::vector<bool> represented(n, false);  // by component
  for (int node = 0; node < n; ++node) {
    if (kept[node]) represented[component[node]] = true;
  }
  for (const int node : ranked) {
    if (!represented[component[node]]) keep(node);
    represented[component[node]] = true;
  }
  std::vector<int> selected;
  for (int node = 0; node < n; ++node) {
    if (kept[node]) selected.push_back(node);
  }
  return selected;
}

}  // namespace overtone
