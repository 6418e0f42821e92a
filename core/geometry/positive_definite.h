// SPDX-License-Identifier: Apache-2.0
// Whether a matrix from outside is a covariance or an information at all.
#ifndef OVERTONE_CORE_GEOMETRY_POSITIVE_DEFINITE_H_
#define OVERTONE_CORE_GEOMETRY_POSITIVE_DEFINITE_H_

#include "Eigen/Cholesky"

namespace overtone {

// symmetric: square; its lower triangle is read, all of it must be finite. False also where the
// factor overflows: Eigen's LLT alone takes a pivot that is NaN for a good one.
template <typename Matrix>
bool IsPositiveDefinite(const Matrix& symmetric) {
  const Eigen::LLT<Matrix> factor(symmetric);
  return factor.info() == Eigen::Success && factor.matrixLLT().allFinite();
}

}  // namespace overtone

#endif  // OVERTONE_CORE_GEOMETRY_POSITIVE_DEFINITE_H_
