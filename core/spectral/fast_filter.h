// SPDX-License-Identifier: Apache-2.0
// Meyer wavelet coefficients of large graphs: the Krylov filter where its basis fits, the Chebyshev
// filter beyond.
#ifndef OVERTONE_CORE_SPECTRAL_FAST_FILTER_H_
#define OVERTONE_CORE_SPECTRAL_FAST_FILTER_H_

#include "Eigen/Core"
#include "absl/status/statusor.h"
#include "overtone/core/spectral/edge_weights.h"
#include "overtone/core/spectral/filter_convergence.h"

namespace overtone {

// O(edges x order), never n x n numbers. Krylov takes the fewer steps, Chebyshev the less memory;
// the line between them is 20,000 nodes for one signal, 3,333 for six: a basis of 32 MB at
// dimension 200, or 16 MB in single precision. laplacian: n x n, symmetric, rows sum to 0. signals:
// n x c, finite, any c; six at a time. lmax: of this Laplacian where it is known, as a FilterResult
// has it; 0: to be found. InvalidArgument: not a Laplacian. ResourceExhausted: not within tolerance
// at the largest order.
absl::StatusOr<FilterResult> FastFilter(const SparseMatrix& laplacian,
                                        const Eigen::MatrixXd& signals, int num_scales,
                                        double tolerance, double lmax = 0);

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_FAST_FILTER_H_
