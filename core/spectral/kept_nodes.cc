// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/kept_nodes.h"

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/spectral/graph_laplacian.h"

namespace overtone {
namespace {

absl::Status CheckReachable(const SparseMatrix& laplacian, const NodePartition& partition) {
  std::vector<bool> reached(laplacian.rows(), false);
  for (const int node : partition.kept) reached[node] = true;
  std::vector<int> frontier = partition.kept;
  while (!frontier.empty()) {
    const int node = frontier.back();
    frontier.pop_back();
    for (SparseMatrix::InnerIterator entry(laplacian, node); entry; ++entry) {
      if (entry.value() < 0 && !reached[entry.row()]) {
        reached[entry.row()] = true;
        frontier.push_back(static_cast<int>(entry.row()));
      }
    }
  }
  for (const int node : partition.eliminated) {
    if (!reached[node]) {
      return absl::FailedPreconditionError(
          absl::StrCat("Kron reduction: eliminated node ", node, " reaches no kept node"));
    }
  }
  return absl::OkStatus();
}

}  // namespace

absl::StatusOr<NodePartition> PartitionNodes(const SparseMatrix& laplacian,
                                             const std::vector<int>& kept_nodes) {
  RETURN_IF_ERROR(ValidateLaplacian(laplacian));
  const int n = static_cast<int>(laplacian.rows());
  if (kept_nodes.empty()) return absl::InvalidArgumentError("kept_nodes: empty");
  NodePartition partition;
  partition.kept = kept_nodes;
  partition.position.assign(n, -1);
  for (size_t i = 0; i < kept_nodes.size(); ++i) {
    const int node = kept_nodes[i];
    if (node < 0 || node >= n) {
      return absl::InvalidArgumentError(
          absl::StrCat("kept_nodes[", i, "]: ", node, " is not in [0, ", n, ")"));
    }
    if (partition.position[node] >= 0) {
      return absl::InvalidArgumentError(
          absl::StrCat("kept_nodes[", i, "]: ", node, " is repeated"));
    }
    partition.position[node] = static_cast<int>(i);
  }
  for (int node = 0; node < n; ++node) {
    if (partition.position[node] >= 0) continue;
    partition.position[node] = -1 - static_cast<int>(partition.eliminated.size());
    partition.eliminated.push_back(node);
  }
  RETURN_IF_ERROR(CheckReachable(laplacian, partition));
  return partition;
}

}  // namespace overtone
