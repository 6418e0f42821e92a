// SPDX-License-Identifier: Apache-2.0
// The spectrum of a graph: eigenpairs of its Laplacian. Exact; for small graphs and as the
// reference of the fast filter.
#ifndef OVERTONE_CORE_SPECTRAL_GRAPH_FOURIER_TRANSFORM_H_
#define OVERTONE_CORE_SPECTRAL_GRAPH_FOURIER_TRANSFORM_H_

#include "Eigen/Core"
#include "absl/status/statusor.h"
#include "overtone/core/spectral/edge_weights.h"

namespace overtone {

// L = U diag(lambda) U^T. The graph Fourier transform of a signal f is U^T f.
struct GraphSpectrum {
  Eigen::VectorXd eigenvalues;   // n, increasing, in [0, inf); the first is exactly 0
  Eigen::MatrixXd eigenvectors;  // n x n, U: column k belongs to eigenvalue k

  double largest_eigenvalue() const {
    return eigenvalues.size() == 0 ? 0 : eigenvalues.tail<1>()[0];
  }
};

// O(n^3) time, O(n^2) memory: 8 n^2 bytes three times over. laplacian: n x n, symmetric, rows sum
// to 0. InvalidArgument: not a Laplacian (ValidateLaplacian). Internal: the eigensolver did not
// converge.
absl::StatusOr<GraphSpectrum> GraphFourierTransform(const SparseMatrix& laplacian);

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_GRAPH_FOURIER_TRANSFORM_H_
