// SPDX-License-Identifier: Apache-2.0
// Meyer wavelet coefficients by Lanczos: g_s(L) f = |f| V_m g_s(T_m) e_1. One Krylov space serves
// every scale.
#ifndef OVERTONE_CORE_SPECTRAL_KRYLOV_FILTER_H_
#define OVERTONE_CORE_SPECTRAL_KRYLOV_FILTER_H_

#include "Eigen/Core"
#include "absl/status/statusor.h"
#include "overtone/core/spectral/edge_weights.h"
#include "overtone/core/spectral/filter_convergence.h"

namespace overtone {

// Grows the space until the estimated error is within `tolerance`. lmax comes from one more start
// vector in the same passes over the matrix, and its remaining error is part of the estimate.
// Adapts to the spectrum and to the signal: a signal made of few eigenvectors takes few steps.
// Memory: 8 n c m bytes for the basis, m about 100 to 200; half of it on large graphs, where it is
// kept in single precision unless `tolerance` asks for more.
// laplacian: n x n. signals: n x c, finite, c <= 7. lmax: of this Laplacian where it is known, as a
// FilterResult has it; 0: found on the way.
// ResourceExhausted: not within tolerance at m = max_dimension. Internal: the tridiagonal
// eigensolver failed.
absl::StatusOr<FilterResult> KrylovFilter(const SparseMatrix& laplacian,
                                          const Eigen::MatrixXd& signals, int num_scales,
                                          double tolerance, int max_dimension, double lmax = 0);

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_KRYLOV_FILTER_H_
