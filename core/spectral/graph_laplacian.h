// SPDX-License-Identifier: Apache-2.0
// The combinatorial graph Laplacian.
#ifndef OVERTONE_CORE_SPECTRAL_GRAPH_LAPLACIAN_H_
#define OVERTONE_CORE_SPECTRAL_GRAPH_LAPLACIAN_H_

#include "absl/status/status.h"
#include "overtone/core/spectral/edge_weights.h"

namespace overtone {

// L = D - A, D the diagonal of A's row sums. Rows sum to 0, positive semi-definite for non-negative
// weights. Every diagonal entry is stored, that of an isolated node as 0. adjacency: n x n,
// symmetric, no diagonal (edge_weights.h).
SparseMatrix GraphLaplacian(const SparseMatrix& adjacency);

// A = -offdiag(L), the way back. Entries that are not positive are left out.
SparseMatrix AdjacencyFromLaplacian(const SparseMatrix& laplacian);

// Ok when `laplacian` is square, finite and symmetric, its rows sum to 0 and no off-diagonal entry
// is positive; each up to round-off of its largest diagonal entry. InvalidArgument saying which
// fails, and where. O(entries).
absl::Status ValidateLaplacian(const SparseMatrix& laplacian);

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_GRAPH_LAPLACIAN_H_
