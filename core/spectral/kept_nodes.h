// SPDX-License-Identifier: Apache-2.0
// The partition of a graph into kept and eliminated nodes.
#ifndef OVERTONE_CORE_SPECTRAL_KEPT_NODES_H_
#define OVERTONE_CORE_SPECTRAL_KEPT_NODES_H_

#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/spectral/edge_weights.h"

namespace overtone {

struct NodePartition {
  std::vector<int> kept;        // as given
  std::vector<int> eliminated;  // increasing
  std::vector<int>
      position;  // of a kept node in `kept`; of an eliminated node -1 - its place in `eliminated`
};

// Checks both arguments of a Kron reduction. InvalidArgument: not a Laplacian; kept_nodes empty,
// repeated or out of range. FailedPrecondition: an eliminated node that no path joins to a kept
// one, found by breadth-first search.
absl::StatusOr<NodePartition> PartitionNodes(const SparseMatrix& laplacian,
                                             const std::vector<int>& kept_nodes);

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_KEPT_NODES_H_
