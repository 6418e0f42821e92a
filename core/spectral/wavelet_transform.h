// SPDX-License-Identifier: Apache-2.0
// Spectral graph wavelet coefficients of signals on a graph. Hammond et al., ACHA 2011.
#ifndef OVERTONE_CORE_SPECTRAL_WAVELET_TRANSFORM_H_
#define OVERTONE_CORE_SPECTRAL_WAVELET_TRANSFORM_H_

#include <vector>

#include "Eigen/Core"
#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/spectral/edge_weights.h"

namespace overtone {

enum class FilterMethod {
  kAuto,   // exact for small graphs, fast for large ones
  kExact,  // full eigendecomposition, O(n^3)
  kFast,   // Krylov or polynomial filter, O(edges); estimated error within `tolerance`
};

struct WaveletOptions {
  int num_scales = 6;  // 3..9; index 0 = lowest graph frequency = widest neighbourhood
  FilterMethod method = FilterMethod::kAuto;
  int exact_up_to_nodes = 100;  // kAuto; about where both take as long
  double tolerance = 1e-4;      // kFast: largest error over the largest coefficient

  absl::Status Validate() const;
};

// result[s](n, c) = (g_s(L) f_c)_n for the Meyer bank g of `laplacian` (n x n, symmetric, rows sum
// to 0) and the signals f_c, the columns of `signals` (n x c). Since server and robot share psi,
// the difference of their coefficients is the transform of the difference of their signals: pass
// that.
// InvalidArgument: options invalid, sizes differ, a signal not finite, not a Laplacian.
// ResourceExhausted: kFast did not reach the tolerance.
absl::StatusOr<std::vector<Eigen::MatrixXd>> WaveletCoefficients(const SparseMatrix& laplacian,
                                                                 const Eigen::MatrixXd& signals,
                                                                 const WaveletOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_WAVELET_TRANSFORM_H_
