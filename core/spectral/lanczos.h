// SPDX-License-Identifier: Apache-2.0
// Lanczos recurrences L V_m = V_m T_m + beta_m v_{m+1} e_m^T of a symmetric matrix, without
// reorthogonalisation: its extreme eigenvalues and f(L) b converge all the same (Druskin &
// Knizhnerman, Comp. Math. & Math. Phys. 31, 1991).
#ifndef OVERTONE_CORE_SPECTRAL_LANCZOS_H_
#define OVERTONE_CORE_SPECTRAL_LANCZOS_H_

#include <vector>

#include "Eigen/Core"
#include "overtone/core/spectral/edge_weights.h"

namespace overtone {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// product = symmetric * vectors, streaming the matrix once for all columns; this is where the time
// goes. symmetric: n x n, both triangles stored. vectors, product: n x c, c <= 8, product of that
// size already.
void MultiplySymmetric(const SparseMatrix& symmetric, const RowMajorMatrix& vectors,
                       RowMajorMatrix& product);

// The tridiagonal T_m of one start vector b.
struct LanczosTridiagonal {
  double start_norm = 0;            // |b|
  std::vector<double> diagonal;     // alpha, m
  std::vector<double> subdiagonal;  // beta, m; the last couples to v_{m+1}
  bool exhausted =
      false;  // the Krylov space is invariant: T is complete and further steps add nothing

  int dimension() const { return static_cast<int>(diagonal.size()); }
};

// Several start vectors in lockstep, so that they share every pass over the matrix.
class LockstepLanczos {
 public:
  // laplacian: n x n, must outlive this. starts: n x c, c <= 8; a zero column is exhausted from the
  // start.
  LockstepLanczos(const SparseMatrix& laplacian, const Eigen::MatrixXd& starts);

  // n x c: v_{m+1} of every column, unit length, or 0 when exhausted.
  const RowMajorMatrix& vectors() const { return vectors_; }
  const LanczosTridiagonal& tridiagonal(int column) const { return tridiagonals_[column]; }
  int num_columns() const { return static_cast<int>(vectors_.cols()); }  // still stepping
  bool AllExhausted() const;

  // Steps without it from now on; its tridiagonal stays.
  void DropLastColumn();

  // m -> m + 1.
  void Step();

 private:
  const SparseMatrix& laplacian_;
  double breakdown_;  // couplings at most this long are round-off
  RowMajorMatrix previous_, vectors_, product_;
  std::vector<LanczosTridiagonal> tridiagonals_;
};

// A start vector that finds lmax: pseudo-random, the same on every machine, so with a part in every
// eigenspace; a hundred times larger about the nodes of largest degree, where the top eigenvectors
// of a radius graph live. (At dimension 150 of 5,000 nodes this saved a factor of ten in error.)
Eigen::VectorXd LmaxStartVector(const SparseMatrix& laplacian);

// The largest eigenvalue of T_m; 0 for m = 0. A lower bound of the matrix's.
double LargestRitzValue(const LanczosTridiagonal& tridiagonal);

// lmax of a Laplacian, relative error at most about 1e-6: a feature's error is 2.5 to 4 times that
// of lmax. About 60 products, several times as many where large eigenvalues crowd.
double LargestEigenvalue(const SparseMatrix& laplacian);

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_LANCZOS_H_
