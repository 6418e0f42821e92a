// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/krylov_filter.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/spectral/lanczos.h"
#include "overtone/core/spectral/meyer_wavelets.h"

namespace overtone {
namespace {

// The signals in the first columns, the start vector that looks for lmax in the last.
Eigen::MatrixXd StartVectors(const Eigen::MatrixXd& signals) {
  Eigen::MatrixXd starts(signals.rows(), signals.cols() + 1);
  starts << signals, GenericStartVector(static_cast<int>(signals.rows()));
  return starts;
}

// The basis V of each signal, n x capacity, grown by doubling.
class KrylovBases {
 public:
  explicit KrylovBases(int num_signals) : bases_(num_signals) {}

  const Eigen::MatrixXd& basis(int signal) const { return bases_[signal]; }
  void Append(const RowMajorMatrix& vectors) {
    for (size_t c = 0; c < bases_.size(); ++c) {
      if (size_ == bases_[c].cols()) {
        bases_[c].conservativeResize(vectors.rows(), std::max<Eigen::Index>(64, 2 * size_));
      }
      bases_[c].col(size_) = vectors.col(c);
    }
    ++size_;
  }

 private:
  Eigen::Index size_ = 0;
  std::vector<Eigen::MatrixXd> bases_;
};

// |f| g_s(T) e_1, m x num_scales.
absl::StatusOr<Eigen::MatrixXd> ProjectedFilter(const LanczosTridiagonal& tridiagonal,
                                                const MeyerFilterBank& bank) {
  Eigen::VectorXd eigenvalues;
  Eigen::MatrixXd q;
  if (!DecomposeTridiagonal(tridiagonal, eigenvalues, &q)) {
    return absl::InternalError("Krylov filter: the tridiagonal eigensolver did not converge");
  }
  const Eigen::MatrixXd kernels = bank.Evaluate(eigenvalues.cwiseMax(0.0)).transpose();
  return (tridiagonal.start_norm * q) * (q.row(0).transpose().asDiagonal() * kernels);
}

absl::StatusOr<std::vector<Eigen::MatrixXd>> Coefficients(const LockstepLanczos& lanczos,
                                                          const KrylovBases& bases, int num_signals,
                                                          const MeyerFilterBank& bank) {
  const Eigen::Index n = lanczos.vectors().rows();
  std::vector<Eigen::MatrixXd> coefficients(bank.num_scales(),
                                            Eigen::MatrixXd::Zero(n, num_signals));
  for (int c = 0; c < num_signals; ++c) {
    const LanczosTridiagonal& tridiagonal = lanczos.tridiagonal(c);
    if (tridiagonal.dimension() == 0) continue;  // a zero signal
    ASSIGN_OR_RETURN(const Eigen::MatrixXd projected, ProjectedFilter(tridiagonal, bank));
    const Eigen::MatrixXd filtered = bases.basis(c).leftCols(tridiagonal.dimension()) * projected;
    for (int s = 0; s < bank.num_scales(); ++s) coefficients[s].col(c) = filtered.col(s);
  }
  return coefficients;
}

double LargestRitzValueOfAll(const LockstepLanczos& lanczos, int num_columns) {
  double largest = 0;
  for (int c = 0; c < num_columns; ++c) {
    largest = std::max(largest, LargestRitzValue(lanczos.tridiagonal(c)));
  }
  return largest;
}

}  // namespace

absl::StatusOr<FilterResult> KrylovFilter(const SparseMatrix& laplacian,
                                          const Eigen::MatrixXd& signals, int num_scales,
                                          double tolerance, int max_dimension) {
  const int num_signals = static_cast<int>(signals.cols());
  LockstepLanczos lanczos(laplacian, StartVectors(signals));
  KrylovBases bases(num_signals);
  FilterConvergence convergence(tolerance);
  FilterResult result;
  int next_check = 50;
  while (true) {
    bases.Append(lanczos.vectors());
    lanczos.Step();
    ++result.order;
    const bool exhausted = lanczos.AllExhausted();
    if (result.order < next_check && !exhausted) continue;
    result.lmax = LargestRitzValueOfAll(lanczos, num_signals + 1);
    const MeyerFilterBank bank(result.lmax, num_scales);
    ASSIGN_OR_RETURN(result.coefficients, Coefficients(lanczos, bases, num_signals, bank));
    if (exhausted) return result;  // the spaces are invariant: nothing is missing
    if (convergence.Update(result.coefficients)) break;
    next_check = FilterConvergence::NextOrder(result.order);
    if (next_check > max_dimension) {
      return absl::ResourceExhaustedError(
          absl::StrCat("Krylov filter: error about ", convergence.error_estimate(),
                       " at dimension ", result.order, ", above ", tolerance));
    }
  }
  result.error_estimate = convergence.error_estimate();
  return result;
}

}  // namespace overtone
