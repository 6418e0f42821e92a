// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/krylov_filter.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <utility>
#include <vector>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/spectral/krylov_basis.h"
#include "overtone/core/spectral/lanczos.h"
#include "overtone/core/spectral/meyer_wavelets.h"
#include "overtone/core/spectral/tridiagonal_eigensystem.h"

namespace overtone {
namespace {

// The signals in the first columns; where lmax is not known, the start vector that looks for it in
// the last.
Eigen::MatrixXd StartVectors(const SparseMatrix& laplacian, const Eigen::MatrixXd& signals,
                             bool lmax_known) {
  if (lmax_known) return signals;
  Eigen::MatrixXd starts(signals.rows(), signals.cols() + 1);
  starts << signals, LmaxStartVector(laplacian);
  return starts;
}

// lmax as the signals' spaces and that of the last column's start vector know it.
class LmaxEstimate {
 public:
  // known: 0 where it is not.
  LmaxEstimate(int num_signals, double known) : num_signals_(num_signals), known_(known) {}

  // Drops the last column once it has settled. (Not when a signal sees higher: on a large radius
  // graph one did at dimension 50, and at 190 was ten times farther from lmax.)
  double Update(LockstepLanczos& lanczos) {
    if (known_ > 0) return known_;
    const LanczosTridiagonal& last_column = lanczos.tridiagonal(num_signals_);
    double largest = LargestRitzValue(last_column);
    if (last_column.dimension() >= next_comparison_) {  // far enough on for the gain to tell
      const bool settled = compared_ > 0 && largest - compared_ <= 1e-7 * largest;
      if (settled && lanczos.num_columns() > num_signals_) lanczos.DropLastColumn();
      compared_ = largest;
      next_comparison_ = last_column.dimension() * 5 / 4;
    }
    for (int c = 0; c < num_signals_; ++c) {
      largest = std::max(largest, LargestRitzValue(lanczos.tridiagonal(c)));
    }
    return largest;
  }

 private:
  const int num_signals_;
  const double known_;
  double compared_ = 0;
  int next_comparison_ = 0;
};

// The coefficients at dimension m are a signal's basis times these.
struct Look {
  int order = 0;
  std::vector<Eigen::MatrixXd> weights;  // per signal, m x scales: |f| g_s(T_m) e_1; none for f = 0
};

absl::StatusOr<Look> TakeLook(const LockstepLanczos& lanczos, int num_signals, int order,
                              const MeyerFilterBank& bank) {
  Look look{order, std::vector<Eigen::MatrixXd>(num_signals)};
  for (int c = 0; c < num_signals; ++c) {
    const LanczosTridiagonal& t = lanczos.tridiagonal(c);
    if (t.dimension() == 0) continue;
    const TridiagonalEigensystem system(t.diagonal, t.subdiagonal);
    if (!system.ok()) {
      return absl::InternalError("Krylov filter: the tridiagonal eigensolver did not converge");
    }
    const Eigen::MatrixXd kernels = bank.Evaluate(system.eigenvalues().cwiseMax(0.0)).transpose();
    look.weights[c] = t.start_norm * system.FunctionsTimesFirstUnit(kernels);
  }
  return look;
}

// The coefficients, and by how much they differ from those at an earlier look: the largest change
// over the largest coefficient of the same signal.
struct Outcome {
  std::vector<Eigen::MatrixXd> coefficients;  // per scale, n x signals
  double change = 0;
};

template <typename Scalar>
Outcome Evaluate(const KrylovBases<Scalar>& bases, const Look& now, const Look& before,
                 Eigen::Index num_rows, int num_scales) {
  const int num_signals = static_cast<int>(now.weights.size());
  Outcome outcome;
  outcome.coefficients.assign(num_scales, Eigen::MatrixXd::Zero(num_rows, num_signals));
  for (int c = 0; c < num_signals; ++c) {
    const Eigen::MatrixXd& weights = now.weights[c];
    if (weights.rows() == 0) continue;
    Eigen::MatrixXd both(weights.rows(), 2 * num_scales);
    both << weights, weights;
    both.topRightCorner(before.weights[c].rows(), before.weights[c].cols()) -= before.weights[c];
    const Eigen::MatrixXd product = bases.Combine(c, both);
    const double largest = product.leftCols(num_scales).cwiseAbs().maxCoeff();
    const double change = product.rightCols(num_scales).cwiseAbs().maxCoeff();
    if (change > 0) outcome.change = std::max(outcome.change, change / largest);
    for (int s = 0; s < num_scales; ++s) outcome.coefficients[s].col(c) = product.col(s);
  }
  return outcome;
}

// Some rows of the basis, evenly spread, tell cheaply that the filter has not converged yet.
std::vector<int> ProbedRows(Eigen::Index num_rows) {
  constexpr Eigen::Index kProbes = 256;
  const Eigen::Index step = std::max<Eigen::Index>(1, num_rows / kProbes);
  std::vector<int> rows;
  for (Eigen::Index row = 0; row < num_rows; row += step) rows.push_back(static_cast<int>(row));
  return rows;
}

constexpr Eigen::Index kLargeGraph = 2000;

// A quarter on; on large graphs, where a look is cheap beside the steps, less when the tolerance is
// near: the error falls with the fourth power of the order, or faster.
int NextLook(int order, double error_over_tolerance, Eigen::Index num_rows) {
  const double growth =
      num_rows < kLargeGraph ? 1.25 : std::clamp(std::pow(error_over_tolerance, 0.125), 1.08, 1.25);
  return order + std::max(4, static_cast<int>(order * (growth - 1)));
}

// The last look at least a fifth back; the ones before it are dropped.
const Look* Reference(std::deque<Look>& looks) {
  const double latest = 0.81 * looks.back().order;
  while (looks.size() > 1 && looks[1].order <= latest) looks.pop_front();
  return looks.front().order <= latest ? &looks.front() : nullptr;
}

template <typename Scalar>
absl::StatusOr<FilterResult> Filter(const SparseMatrix& laplacian, const Eigen::MatrixXd& signals,
                                    int num_scales, double tolerance, int max_dimension,
                                    double known_lmax) {
  const int num_signals = static_cast<int>(signals.cols());
  LockstepLanczos lanczos(laplacian, StartVectors(laplacian, signals, known_lmax > 0));
  KrylovBases<Scalar> bases(num_signals);
  KrylovBases<double> probe(num_signals);
  const std::vector<int> probed_rows = ProbedRows(signals.rows());
  LmaxEstimate lmax(num_signals, known_lmax);
  std::deque<Look> looks;
  FilterResult result;
  result.error_estimate = std::numeric_limits<double>::infinity();
  int next_look = tolerance < 1e-2 ? 50 : 32;
  while (true) {
    bases.Append(lanczos.vectors());
    probe.Append(lanczos.vectors()(probed_rows, Eigen::all));
    lanczos.Step();
    ++result.order;
    const bool exhausted = lanczos.AllExhausted();
    if (result.order < next_look && !exhausted) continue;
    result.lmax = lmax.Update(lanczos);
    const MeyerFilterBank bank(result.lmax, num_scales);
    ASSIGN_OR_RETURN(Look look, TakeLook(lanczos, num_signals, result.order, bank));
    looks.push_back(std::move(look));
    if (exhausted) {  // the spaces are invariant: nothing is missing
      const Look& last = looks.back();
      result.coefficients = Evaluate(bases, last, last, signals.rows(), num_scales).coefficients;
      result.error_estimate = 0;
      return result;
    }
    if (const Look* const before = Reference(looks)) {
      const Look& now = looks.back();
      result.error_estimate = Evaluate(probe, now, *before, probed_rows.size(), num_scales).change;
      if (result.error_estimate <= tolerance) {
        Outcome outcome = Evaluate(bases, now, *before, signals.rows(), num_scales);
        result.coefficients = std::move(outcome.coefficients);
        result.error_estimate = outcome.change;
        if (outcome.change <= tolerance) return result;
      }
    }
    next_look = NextLook(result.order, result.error_estimate / tolerance, signals.rows());
    if (next_look > max_dimension) {
      return absl::ResourceExhaustedError(absl::StrCat("Krylov filter: error about ",
                                                       result.error_estimate, " at dimension ",
                                                       result.order, ", above ", tolerance));
    }
  }
}

}  // namespace

absl::StatusOr<FilterResult> KrylovFilter(const SparseMatrix& laplacian,
                                          const Eigen::MatrixXd& signals, int num_scales,
                                          double tolerance, int max_dimension, double lmax) {
  // Rounding a basis to single precision moves a coefficient by about 1e-6 of the largest.
  const bool compact = signals.rows() >= kLargeGraph && tolerance >= 5e-5;
  return compact ? Filter<float>(laplacian, signals, num_scales, tolerance, max_dimension, lmax)
                 : Filter<double>(laplacian, signals, num_scales, tolerance, max_dimension, lmax);
}

}  // namespace overtone
