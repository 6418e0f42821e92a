// SPDX-License-Identifier: Apache-2.0
// What whitens an error e: S with S^T * S = information, so that |S e|^2 = e^T information e.
#ifndef OVERTONE_CORE_ESTIMATION_SQUARE_ROOT_INFORMATION_H_
#define OVERTONE_CORE_ESTIMATION_SQUARE_ROOT_INFORMATION_H_

#include "absl/status/statusor.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

// The transposed Cholesky factor, L^T of L * L^T; for a semi-definite matrix the root by
// eigenvalues. InvalidArgument: not finite, not symmetric, or an eigenvalue clearly below 0.
absl::StatusOr<Eigen::Matrix3d> SquareRootInformation(const Eigen::Matrix3d& information);
absl::StatusOr<Matrix6d> SquareRootInformation(const Matrix6d& information);

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_SQUARE_ROOT_INFORMATION_H_
