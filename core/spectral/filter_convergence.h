// SPDX-License-Identifier: Apache-2.0
// When an iterative filter may stop.
#ifndef OVERTONE_CORE_SPECTRAL_FILTER_CONVERGENCE_H_
#define OVERTONE_CORE_SPECTRAL_FILTER_CONVERGENCE_H_

#include <limits>
#include <vector>

#include "Eigen/Core"

namespace overtone {

// Compares the coefficients at orders a quarter apart. The Meyer kernels are smooth to third order,
// so the error falls with the fourth power of the order, or faster: by 2.4 or more from one look to
// the next. What changed is then more than what is still missing, and is taken as the error.
// (Extrapolating from two changes would stop earlier, but was up to 15 times too hopeful.) Per
// signal: largest change over largest coefficient; the worst signal counts.
class FilterConvergence {
 public:
  explicit FilterConvergence(double tolerance) : tolerance_(tolerance) {}

  // The next order at which to look again.
  static int NextOrder(int order) { return order + order / 4; }

  // True when the estimated error is within tolerance: not before the second call. result[s]: n x
  // c.
  bool Update(const std::vector<Eigen::MatrixXd>& coefficients);

  double error_estimate() const { return error_estimate_; }

 private:
  double tolerance_;
  double error_estimate_ = std::numeric_limits<double>::infinity();
  std::vector<Eigen::MatrixXd> last_;
};

// What an iterative filter returns.
struct FilterResult {
  std::vector<Eigen::MatrixXd> coefficients;  // per scale, n x c
  double lmax = 0;
  int order = 0;              // products with the Laplacian spent on the signals
  double error_estimate = 0;  // largest error over the largest coefficient of the same signal
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SPECTRAL_FILTER_CONVERGENCE_H_
