// SPDX-License-Identifier: Apache-2.0
// Which nodes a Kron reduction keeps.
#ifndef OVERTONE_CORE_SPECTRAL_REDUCTION_NODE_SELECTION_H_
#define OVERTONE_CORE_SPECTRAL_REDUCTION_NODE_SELECTION_H_

#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/spectral/edge_weights.h"

namespace overtone {

enum class NodeSelectionRule {
  kAuto,                // the first for small graphs, the second for large ones
  kLargestEigenvector,  // the prototype's: by the largest |U| entry of a node's row; needs all of
                        // U, O(n^3)
  // Of every ten consecutive nodes the same share, those of largest degree (sum of weights) first.
  // O(n). Shares 0.7 of the nodes with the first rule at 60 % kept (0.6 is chance), as many as the
  // best rule we found; ranking by the top 50 or 200 eigenvectors shares 0.6 and drops stretches of
  // 100 nodes and more, where this one drops at most about 10 / share in a row.
  kLocalDegree,
};

struct NodeSelectionOptions {
  NodeSelectionRule rule = NodeSelectionRule::kAuto;
  int eigenvectors_up_to_nodes = 500;  // kAuto; a full spectrum takes 0.2 s there
};

// All nodes, most prominent first.
// InvalidArgument: not a Laplacian. Internal: the eigensolver did not converge.
absl::StatusOr<std::vector<int>> RankNodes(const SparseMatrix& laplacian,
                                           const NodeSelectionOptions& options);

// Increasing: `always_keep`, then the most prominent up to `num_kept` in all; and, beyond that
// number, the most prominent node of each connected component that would have none, since a
// reduction cannot eliminate a whole component. laplacian: n x n; consecutive nodes of a mission
// are consecutive. always_keep: in [0, n), in any order. InvalidArgument: not a Laplacian, num_kept
// not in [1, n], always_keep out of range.
absl::StatusOr<std::vector<int>> SelectNodes(const SparseMatrix& laplacian, int num_kept,
                                             const std::vector<int>& always_keep,
                                             const NodeSelectionOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_REDUCTION_NODE_SELECTION_H_
