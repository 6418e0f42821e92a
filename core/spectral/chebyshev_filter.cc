// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/chebyshev_filter.h"

#include <cmath>

#include "absl/status/status.h"
#include "absl/strings/str_cat.h"
#include "overtone/core/spectral/lanczos.h"

namespace overtone {
namespace {

constexpr int kUsualOrder = 512;  // coefficients cost the square of the order
constexpr int kMaxOrder = 2048;

// T_k(2 L / lmax - 1) f for k = 0, 1, ..., summed with the coefficients of every scale.
class ChebyshevRecurrence {
 public:
  ChebyshevRecurrence(const SparseMatrix& laplacian, double lmax,
                      const Eigen::MatrixXd& coefficients, const Eigen::MatrixXd& signals)
      : laplacian_(laplacian),
        lmax_(lmax),
        coefficients_(coefficients),
        current_(signals),
        previous_(RowMajorMatrix::Zero(signals.rows(), signals.cols())),
        product_(signals.rows(), signals.cols()) {
    for (Eigen::Index s = 0; s < coefficients.rows(); ++s) {
      sums_.push_back(0.5 * coefficients(s, 0) * signals);
    }
  }

  int order() const { return order_; }
  std::vector<Eigen::MatrixXd> sums() const { return {sums_.begin(), sums_.end()}; }

  // order -> order + 1, at most the coefficients' order.
  void Step() {
    MultiplySymmetric(laplacian_, current_, product_);
    const double factor = order_ == 0 ? 1 : 2;
    // previous_ is 0 at first.
    previous_ = (factor * 2 / lmax_) * product_ - factor * current_ - previous_;
    previous_.swap(current_);
    ++order_;
    for (size_t s = 0; s < sums_.size(); ++s) sums_[s] += coefficients_(s, order_) * current_;
  }

 private:
  const SparseMatrix& laplacian_;
  const double lmax_;
  const Eigen::MatrixXd& coefficients_;
  RowMajorMatrix current_, previous_, product_;
  std::vector<RowMajorMatrix> sums_;  // as current_: added without striding
  int order_ = 0;
};

}  // namespace

Eigen::MatrixXd ChebyshevCoefficients(const MeyerFilterBank& bank, int order, int num_points) {
  Eigen::VectorXd cosine(num_points);
  for (int j = 0; j < num_points; ++j) cosine[j] = std::cos(M_PI * (j + 0.5) / num_points);
  const Eigen::VectorXd lambdas = 0.5 * bank.lmax() * (cosine.array() + 1).matrix();
  const Eigen::MatrixXd kernels = 2.0 / num_points * bank.Evaluate(lambdas);
  Eigen::MatrixXd coefficients(bank.num_scales(), order + 1);
  Eigen::VectorXd current = Eigen::VectorXd::Ones(num_points), previous = cosine;  // T_0, T_-1
  for (int k = 0; k <= order; ++k) {
    coefficients.col(k) = kernels * current;
    previous = 2 * cosine.cwiseProduct(current) - previous;
    previous.swap(current);
  }
  return coefficients;
}

std::vector<Eigen::MatrixXd> ChebyshevSum(const SparseMatrix& laplacian, double lmax,
                                          const Eigen::MatrixXd& coefficients,
                                          const Eigen::MatrixXd& signals) {
  ChebyshevRecurrence recurrence(laplacian, lmax, coefficients, signals);
  while (recurrence.order() + 1 < coefficients.cols()) recurrence.Step();
  return recurrence.sums();
}

absl::StatusOr<FilterResult> ChebyshevFilter(const SparseMatrix& laplacian,
                                             const Eigen::MatrixXd& signals, int num_scales,
                                             double tolerance, double lmax) {
  FilterResult result;
  result.lmax = lmax > 0 ? lmax : LargestEigenvalue(laplacian);
  if (!(result.lmax > 0)) {  // no edges: every signal is of frequency 0
    result.coefficients.assign(num_scales, Eigen::MatrixXd::Zero(signals.rows(), signals.cols()));
    result.coefficients[0] = signals;
    return result;
  }
  const MeyerFilterBank bank(result.lmax, num_scales);
  const auto coefficients_up_to = [&bank](int order) {
    return ChebyshevCoefficients(bank, order, /*num_points=*/4 * order);
  };
  Eigen::MatrixXd coefficients = coefficients_up_to(kUsualOrder);
  ChebyshevRecurrence recurrence(laplacian, result.lmax, coefficients, signals);
  FilterConvergence convergence(tolerance);
  int next_check = 80;
  while (next_check <= kMaxOrder) {
    if (next_check >= coefficients.cols()) coefficients = coefficients_up_to(kMaxOrder);
    while (recurrence.order() < next_check) recurrence.Step();
    result.coefficients = recurrence.sums();
    if (convergence.Update(result.coefficients)) {
      result.order = recurrence.order();
      result.error_estimate = convergence.error_estimate();
      return result;
    }
    next_check = FilterConvergence::NextOrder(next_check);
  }
  return absl::ResourceExhaustedError(absl::StrCat("Chebyshev filter: error about ",
                                                   convergence.error_estimate(), " at order ",
                                                   recurrence.order(), ", above ", tolerance));
}

}  // namespace overtone
