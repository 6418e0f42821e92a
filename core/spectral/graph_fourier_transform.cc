// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/graph_fourier_transform.h"

#include "Eigen/Eigenvalues"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/spectral/graph_laplacian.h"

namespace overtone {

absl::StatusOr<GraphSpectrum> GraphFourierTransform(const SparseMatrix& laplacian) {
  RETURN_IF_ERROR(ValidateLaplacian(laplacian));
  GraphSpectrum spectrum;
  if (laplacian.rows() == 0) return spectrum;
  Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver{Eigen::MatrixXd(laplacian)};
  if (solver.info() != Eigen::Success) {
    return absl::InternalError("graph spectrum: the eigensolver did not converge");
  }
  // The constant signal has frequency 0; round-off must not make any frequency negative.
  spectrum.eigenvalues = solver.eigenvalues().cwiseMax(0.0);
  spectrum.eigenvalues[0] = 0;
  spectrum.eigenvectors = solver.eigenvectors();
  return spectrum;
}

}  // namespace overtone
