// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/fast_filter.h"

#include <algorithm>

#include "overtone/core/common/status_macros.h"
#include "overtone/core/spectral/chebyshev_filter.h"
#include "overtone/core/spectral/graph_laplacian.h"
#include "overtone/core/spectral/krylov_filter.h"

namespace overtone {
namespace {

constexpr int kSignalsAtOnce = 6;
constexpr int64_t kMaxBasisBytes = 32'000'000;
constexpr int kTypicalDimension = 200;
constexpr int kMaxKrylovDimension = 600;

absl::StatusOr<FilterResult> FilterBlock(const SparseMatrix& laplacian,
                                         const Eigen::MatrixXd& signals, int num_scales,
                                         double tolerance, double lmax) {
  const int64_t basis_bytes = int64_t{8} * kTypicalDimension * signals.size();
  if (basis_bytes <= kMaxBasisBytes) {
    auto krylov =
        KrylovFilter(laplacian, signals, num_scales, tolerance, kMaxKrylovDimension, lmax);
    if (krylov.ok()) return krylov;
  }
  return ChebyshevFilter(laplacian, signals, num_scales, tolerance, lmax);
}

}  // namespace

absl::StatusOr<FilterResult> FastFilter(const SparseMatrix& laplacian,
                                        const Eigen::MatrixXd& signals, int num_scales,
                                        double tolerance, double lmax) {
  RETURN_IF_ERROR(ValidateLaplacian(laplacian));
  FilterResult all;
  all.coefficients.assign(num_scales, Eigen::MatrixXd(signals.rows(), signals.cols()));
  if (signals.size() == 0) return all;
  for (Eigen::Index first = 0; first < signals.cols(); first += kSignalsAtOnce) {
    const Eigen::Index count = std::min<Eigen::Index>(kSignalsAtOnce, signals.cols() - first);
    ASSIGN_OR_RETURN(
        const FilterResult block,
        FilterBlock(laplacian, signals.middleCols(first, count), num_scales, tolerance, lmax));
    for (int s = 0; s < num_scales; ++s) {
      all.coefficients[s].middleCols(first, count) = block.coefficients[s];
    }
    all.lmax = std::max(all.lmax, block.lmax);
    all.order = std::max(all.order, block.order);
    all.error_estimate = std::max(all.error_estimate, block.error_estimate);
  }
  return all;
}

}  // namespace overtone
