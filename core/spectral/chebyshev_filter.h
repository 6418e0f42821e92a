// SPDX-License-Identifier: Apache-2.0
// Meyer wavelet coefficients by Chebyshev polynomials of the Laplacian. Hammond et al., ACHA 2011,
// section 6. No basis is stored: three vectors and one accumulator per scale for each signal. For
// graphs where the Krylov basis would not fit.
#ifndef OVERTONE_CORE_SPECTRAL_CHEBYSHEV_FILTER_H_
#define OVERTONE_CORE_SPECTRAL_CHEBYSHEV_FILTER_H_

#include <vector>

#include "Eigen/Core"
#include "absl/status/statusor.h"
#include "overtone/core/spectral/edge_weights.h"
#include "overtone/core/spectral/filter_convergence.h"
#include "overtone/core/spectral/meyer_wavelets.h"

namespace overtone {

// num_scales x (order + 1): c_k = 2 / Q sum_j cos(k theta_j) g(lmax / 2 (1 + cos theta_j)), theta_j
// = pi (j + 1/2) / Q, so g ~ c_0 / 2 + sum_{k >= 1} c_k T_k. Q = num_points > order; Q = order + 1
// interpolates (pygsp), more approaches the projection and is the more accurate.
Eigen::MatrixXd ChebyshevCoefficients(const MeyerFilterBank& bank, int order, int num_points);

// result[s] = (c_s0 / 2 + sum_k c_sk T_k(2 L / lmax - 1)) signals. lmax > 0, no smaller than L's
// largest eigenvalue by more than 1e-6 of it. signals: n x c, c <= 8.
std::vector<Eigen::MatrixXd> ChebyshevSum(const SparseMatrix& laplacian, double lmax,
                                          const Eigen::MatrixXd& coefficients,
                                          const Eigen::MatrixXd& signals);

// Raises the order until the estimated error is within `tolerance`. signals: n x c, finite, c <= 8.
// lmax: of this Laplacian where it is known, as a FilterResult has it; 0: to be found.
// ResourceExhausted: not within tolerance at order 2048.
absl::StatusOr<FilterResult> ChebyshevFilter(const SparseMatrix& laplacian,
                                             const Eigen::MatrixXd& signals, int num_scales,
                                             double tolerance, double lmax = 0);

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_CHEBYSHEV_FILTER_H_
