// SPDX-License-Identifier: Apache-2.0
// A stretch of odometry seen from its ends. The state of a step is its error e_i, so that
//     x_i = x_{i-1} z_i Exp(e_i),     cost 1/2 |e_i|^2_Sigma_i,
// and the cost of odometry is quadratic without any linearisation. Moving e_i by w_i moves the pose
// by J_r(e_i) w_i; seen from the stretch's first pose a, eta_i = Ad(x_a^-1 x_i) delta_i is a random
// walk:
//     eta_i = eta_{i-1} + G_i w_i,   G_i = Ad(x_a^-1 x_i) J_r(e_i),   w_i ~ N(-e_i, Sigma_i).
// So the stretch a..b is one edge, eta_b - delta_a ~ N(drift, S), with drift = -sum G_i e_i and S =
// sum G_i Sigma_i G_i^T. Given its ends, lambda = S^-1 (eta_b - delta_a - drift), each step becomes
// e_i + w_i = Sigma_i G_i^T lambda. This is exact, the elimination of a random walk's inside.
#ifndef OVERTONE_CORE_SYNCHRONIZATION_ODOMETRY_STRETCH_H_
#define OVERTONE_CORE_SYNCHRONIZATION_ODOMETRY_STRETCH_H_

#include <vector>

#include "overtone/core/geometry/se3.h"
#include "overtone/core/synchronization/chain_smoother.h"
#include "overtone/core/synchronization/twist_matrix.h"

namespace overtone {

struct StepState {
  Vector6d error = Vector6d::Zero();   // e
  Vector6d change = Vector6d::Zero();  // w, as of the last Spread
  TwistMatrix begin_from_step;         // G, as of the last Condense
};

struct OdometryStretch {
  int begin = 0;  // poses of the chain
  int end = 0;
  // As of the last Condense:
  Rigid3d begin_from_end;
  Vector6d drift = Vector6d::Zero();
  Matrix6d information = Matrix6d::Zero();  // S^-1

  // Sums up the steps begin + 1 .. end; returns their cost.
  double Condense(const std::vector<OdometryStep>& odometry, std::vector<StepState>& steps);
  // Given how the ends move, in their own frames, sets the changes of the steps.
  void Spread(const Vector6d& begin_moves, const Vector6d& end_moves,
              const std::vector<OdometryStep>& odometry, std::vector<StepState>& steps) const;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SYNCHRONIZATION_ODOMETRY_STRETCH_H_
