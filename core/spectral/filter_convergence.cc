// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/filter_convergence.h"

#include <algorithm>

namespace overtone {

bool FilterConvergence::Update(const std::vector<Eigen::MatrixXd>& coefficients) {
  if (!last_.empty()) {
    const Eigen::Index num_signals = coefficients[0].cols();
    Eigen::RowVectorXd change = Eigen::RowVectorXd::Zero(num_signals);
    Eigen::RowVectorXd largest = change;
    for (size_t s = 0; s < coefficients.size(); ++s) {
      largest = largest.cwiseMax(coefficients[s].cwiseAbs().colwise().maxCoeff());
      change = change.cwiseMax((coefficients[s] - last_[s]).cwiseAbs().colwise().maxCoeff());
    }
    error_estimate_ = 0;
    for (Eigen::Index c = 0; c < num_signals; ++c) {
      if (change[c] > 0) error_estimate_ = std::max(error_estimate_, change[c] / largest[c]);
    }
  }
  last_ = coefficients;
  return error_estimate_ <= tolerance_;
}

}  // namespace overtone
