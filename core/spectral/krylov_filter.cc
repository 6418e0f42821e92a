// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/krylov_filter.h"

#include <algorithm>
#include <optional>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/spectral/lanczos.h"
#include "overtone/core/spectral/meyer_wavelets.h"
#include "overtone/core/spectral/tridiagonal_eigensystem.h"

namespace overtone {
namespace {

// The signals in the first columns, the start vector that looks for lmax in the last.
Eigen::MatrixXd StartVectors(const SparseMatrix& laplacian, const Eigen::MatrixXd& signals) {
  Eigen::MatrixXd starts(signals.rows(), signals.cols() + 1);
  starts << signals, LmaxStartVector(laplacian);
  return starts;
}

// The basis V of each signal, in blocks of columns: growing copies nothing.
class KrylovBases {
 public:
  explicit KrylovBases(int num_signals) : blocks_(num_signals) {}

  void Append(const RowMajorMatrix& vectors) {
    const int column = size_++ % kBlock;
    for (size_t c = 0; c < blocks_.size(); ++c) {
      if (column == 0) blocks_[c].emplace_back(vectors.rows(), kBlock);
      blocks_[c].back().col(column) = vectors.col(c);
    }
  }

  // The first m vectors of the signal's basis times `weights`, m x k.
  Eigen::MatrixXd Combine(int signal, const Eigen::MatrixXd& weights) const {
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(blocks_[signal][0].rows(), weights.cols());
    const int m = static_cast<int>(weights.rows());
    for (int first = 0; first < m; first += kBlock) {
      const int count = std::min(kBlock, m - first);
      sum.noalias() +=
          blocks_[signal][first / kBlock].leftCols(count) * weights.middleRows(first, count);
    }
    return sum;
  }

 private:
  static constexpr int kBlock = 32;
  int size_ = 0;
  std::vector<std::vector<Eigen::MatrixXd>> blocks_;
};

// The eigensystem of every signal, none for a zero signal.
using Eigensystems = std::vector<std::optional<TridiagonalEigensystem>>;

absl::StatusOr<Eigensystems> Decompose(const LockstepLanczos& lanczos, int num_signals) {
  Eigensystems systems(num_signals);
  for (int c = 0; c < num_signals; ++c) {
    const LanczosTridiagonal& tridiagonal = lanczos.tridiagonal(c);
    if (tridiagonal.dimension() == 0) continue;
    systems[c].emplace(tridiagonal.diagonal, tridiagonal.subdiagonal);
    if (!systems[c]->ok()) {
      return absl::InternalError("Krylov filter: the tridiagonal eigensolver did not converge");
    }
  }
  return systems;
}

// lmax as the signals' spaces and that of the last column's start vector know it.
class LmaxEstimate {
 public:
  explicit LmaxEstimate(int num_signals) : num_signals_(num_signals) {}

  // Drops the last column once it has settled. (Not when a signal sees higher: on a large radius
  // graph one did at dimension 50, and at 190 was ten times farther from lmax.)
  double Update(LockstepLanczos& lanczos) {
    const double before = last_column_;
    last_column_ = LargestRitzValue(lanczos.tridiagonal(num_signals_));
    const bool settled = before > 0 && last_column_ - before <= 1e-7 * last_column_;
    if (settled && lanczos.num_columns() > num_signals_) lanczos.DropLastColumn();
    double largest = last_column_;
    for (int c = 0; c < num_signals_; ++c) {
      largest = std::max(largest, LargestRitzValue(lanczos.tridiagonal(c)));
    }
    return largest;
  }

 private:
  const int num_signals_;
  double last_column_ = 0;
};

// |f| V_m g_s(T_m) e_1 of every signal.
std::vector<Eigen::MatrixXd> Coefficients(const LockstepLanczos& lanczos,
                                          const Eigensystems& systems, const KrylovBases& bases,
                                          int num_signals, const MeyerFilterBank& bank) {
  const Eigen::Index n = lanczos.vectors().rows();
  std::vector<Eigen::MatrixXd> coefficients(bank.num_scales(),
                                            Eigen::MatrixXd::Zero(n, num_signals));
  for (int c = 0; c < num_signals; ++c) {
    if (!systems[c]) continue;
    const Eigen::MatrixXd kernels =
        bank.Evaluate(systems[c]->eigenvalues().cwiseMax(0.0)).transpose();
    const Eigen::MatrixXd filtered = bases.Combine(
        c, lanczos.tridiagonal(c).start_norm * systems[c]->FunctionsTimesFirstUnit(kernels));
    for (int s = 0; s < bank.num_scales(); ++s) coefficients[s].col(c) = filtered.col(s);
  }
  return coefficients;
}

}  // namespace

absl::StatusOr<FilterResult> KrylovFilter(const SparseMatrix& laplacian,
                                          const Eigen::MatrixXd& signals, int num_scales,
                                          double tolerance, int max_dimension) {
  const int num_signals = static_cast<int>(signals.cols());
  LockstepLanczos lanczos(laplacian, StartVectors(laplacian, signals));
  KrylovBases bases(num_signals);
  LmaxEstimate lmax(num_signals);
  FilterConvergence convergence(tolerance);
  FilterResult result;
  int next_check = 50;
  while (true) {
    bases.Append(lanczos.vectors());
    lanczos.Step();
    ++result.order;
    const bool exhausted = lanczos.AllExhausted();
    if (result.order < next_check && !exhausted) continue;
    ASSIGN_OR_RETURN(const Eigensystems systems, Decompose(lanczos, num_signals));
    result.lmax = lmax.Update(lanczos);
    const MeyerFilterBank bank(result.lmax, num_scales);
    result.coefficients = Coefficients(lanczos, systems, bases, num_signals, bank);
    if (exhausted) return result;  // the spaces are invariant: nothing is missing
    const bool converged = convergence.Update(result.coefficients);
    result.error_estimate = convergence.error_estimate();
    if (converged) return result;
    next_check = FilterConvergence::NextOrder(result.order);
    if (next_check > max_dimension) {
      return absl::ResourceExhaustedError(absl::StrCat("Krylov filter: error about ",
                                                       result.error_estimate, " at dimension ",
                                                       result.order, ", above ", tolerance));
    }
  }
}

}  // namespace overtone
