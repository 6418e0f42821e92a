// SPDX-License-Identifier: Apache-2.0
// The most likely poses of a chain of odometry that chords tie together:
//     min  sum_i |Log(z_i^-1 x_{i-1}^-1 x_i)|^2_Sigma_i
//        + sum_c |Log(Z_c^-1 x_from^-1 x_to)|^2_Sigma_c
// by Gauss-Newton. A chain has far more poses than chord ends, so each stretch of odometry between
// two ends is condensed into one edge first (odometry_stretch.h), the small graph of the ends is
// solved by a sparse factorisation, and the correction is spread over each stretch.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_CHAIN_SMOOTHER_H_
#define OVERTONE_CORE_SYNCHRONIZATION_CHAIN_SMOOTHER_H_

#include <cstdint>
#include <vector>

#include "absl/status/statusor.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

struct OdometryStep {
  Rigid3d previous_from_this;
  Matrix6d covariance = Matrix6d::Identity();   // right tangent, positive definite
  Matrix6d information = Matrix6d::Identity();  // its inverse
};

struct Chord {
  int from = 0;  // positions in the chain, different
  int to = 0;
  Rigid3d from_tform_to;
  Matrix6d information = Matrix6d::Identity();
};

struct ChainSmootherResult {
  std::vector<Rigid3d> poses;
  double initial_cost = 0;  // half the sum above
  // As of the last linearisation; the last step lowers it by less than the tolerance.
  double final_cost = 0;
  int iterations = 0;
  bool converged = false;
  // Of the whole chain's Cholesky factor in the order in which it is eliminated here: the insides
  // of stretches, then the chord ends. What a general sparse solver would have to store.
  int64_t factor_non_zeros = 0;
};

struct ChainSmootherOptions {
  int max_iterations = 50;  // corrections of centimetres take three, of hundreds of metres ten
  // Stops with the step that promises to lower the cost by less: 1e-2 is 0.14 standard deviations
  // from the optimum before that step, and a small share of it behind it.
  double cost_tolerance = 1e-2;
};

// poses: start values; poses[0] stays. odometry: as many; odometry[0] is not read.
// O(poses) per iteration plus a sparse factorisation of the chord ends. Internal: the solve failed
// on non-finite values.
absl::StatusOr<ChainSmootherResult> SmoothChain(const std::vector<Rigid3d>& poses,
                                                const std::vector<OdometryStep>& odometry,
                                                const std::vector<Chord>& chords,
                                                const ChainSmootherOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_CHAIN_SMOOTHER_H_
