// SPDX-License-Identifier: Apache-2.0
// Kron reduction: the Laplacian of the graph as seen from the kept nodes,
//     L_red = L_kk - L_ke * L_ee^-1 * L_ek           (Schur complement)
// k = kept, e = eliminated. Doerfler & Bullo, IEEE TCAS-I 60(1), 2013; Bernreiter et al. 2024,
// "Graph Reduction". Seen as a network of conductances, the kept nodes' effective resistances stay
// what they were.
//
// laplacian:  n x n, symmetric, rows sum to 0, no negative weight (graph_laplacian.h).
// kept_nodes: in [0, n), distinct, in any order. Row i of the result is kept_nodes[i].
//
// InvalidArgument: not a Laplacian; kept_nodes empty, repeated or out of range.
// FailedPrecondition: an eliminated node reaches no kept one. Found by search: a Cholesky pivot
// misses it.
#ifndef OVERTONE_CORE_SPECTRAL_KRON_REDUCTION_H_
#define OVERTONE_CORE_SPECTRAL_KRON_REDUCTION_H_

#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/spectral/edge_weights.h"

namespace overtone {

struct KronReductionResult {
  SparseMatrix laplacian;  // rows sum to 0, symmetric, no negative weight
  // Exact: magnitude of the largest weight that round-off had made negative and that was set to 0;
  // about 1e-16 of the largest.
  double largest_clipped_weight = 0;
  // Sparsified: sum of the weights dropped, over the sum of all weights of the given graph.
  double dropped_weight_fraction = 0;
};

// One supernodal sparse factorisation and dense blocks of right-hand sides. Memory: the factor's
// fill, 8 n x 256, and the result, which is as dense as the graph demands: kept nodes joined by a
// path through eliminated ones become neighbours. Internal: the factorisation failed.
absl::StatusOr<KronReductionResult> KronReduction(const SparseMatrix& laplacian,
                                                  const std::vector<int>& kept_nodes);

// Star-mesh elimination node by node, fewest neighbours first: a node's star of weights w_i becomes
// the mesh w_i w_j / sum_k w_k between its neighbours. A new edge below relative_tolerance times
// the graph's largest weight is not made, unless it leads to the star's heaviest neighbour: so what
// was connected stays connected. 0: exact. Rows still sum to 0. InvalidArgument also:
// relative_tolerance not in [0, 1).
absl::StatusOr<KronReductionResult> SparsifiedKronReduction(const SparseMatrix& laplacian,
                                                            const std::vector<int>& kept_nodes,
                                                            double relative_tolerance);

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_KRON_REDUCTION_H_
