// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/wavelet_transform.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/spectral/fast_filter.h"
#include "overtone/core/spectral/graph_fourier_transform.h"
#include "overtone/core/spectral/meyer_wavelets.h"

namespace overtone {
namespace {

// W_s = U g_s(Lambda) U^T f
absl::StatusOr<std::vector<Eigen::MatrixXd>> ExactCoefficients(const SparseMatrix& laplacian,
                                                               const Eigen::MatrixXd& signals,
                                                               int num_scales) {
  ASSIGN_OR_RETURN(const GraphSpectrum spectrum, GraphFourierTransform(laplacian));
  const MeyerFilterBank bank(spectrum.largest_eigenvalue(), num_scales);
  const Eigen::MatrixXd kernels = bank.Evaluate(spectrum.eigenvalues);
  const Eigen::MatrixXd transformed = spectrum.eigenvectors.transpose() * signals;
  std::vector<Eigen::MatrixXd> coefficients;
  for (int s = 0; s < num_scales; ++s) {
    coefficients.push_back(spectrum.eigenvectors *
                           (kernels.row(s).transpose().asDiagonal() * transformed));
  }
  return coefficients;
}

}  // namespace

absl::Status WaveletOptions::Validate() const {
  if (num_scales < 3 || num_scales > 9) {
    return absl::InvalidArgumentError(
        absl::StrCat("num_scales: ", num_scales, " is not in [3, 9]"));
  }
  if (exact_up_to_nodes < 0) {
    return absl::InvalidArgumentError(
        absl::StrCat("exact_up_to_nodes: ", exact_up_to_nodes, " is negative"));
  }
  if (!(tolerance > 0) || !(tolerance < 1)) {
    return absl::InvalidArgumentError(absl::StrCat("tolerance: ", tolerance, " is not in (0, 1)"));
  }
  return absl::OkStatus();
}

absl::StatusOr<std::vector<Eigen::MatrixXd>> WaveletCoefficients(const SparseMatrix& laplacian,
                                                                 const Eigen::MatrixXd& signals,
                                                                 const WaveletOptions& options) {
  RETURN_IF_ERROR(options.Validate());
  if (signals.rows() != laplacian.rows()) {
    return absl::InvalidArgumentError(
        absl::StrCat("signals: ", signals.rows(), " rows for ", laplacian.rows(), " nodes"));
  }
  if (!signals.allFinite()) return absl::InvalidArgumentError("signals: not finite");
  const bool exact =
      options.method == FilterMethod::kExact ||
      (options.method == FilterMethod::kAuto && laplacian.rows() <= options.exact_up_to_nodes);
  if (exact) return ExactCoefficients(laplacian, signals, options.num_scales);
  ASSIGN_OR_RETURN(FilterResult fast,
                   FastFilter(laplacian, signals, options.num_scales, options.tolerance));
  return std::move(fast.coefficients);
}

}  // namespace overtone
