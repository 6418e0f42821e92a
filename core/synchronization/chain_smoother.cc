// SPDX-License-Identifier: Apache-2.0
//
// The linearised chain. x_i moves to x_i Exp(delta_i); an odometry residual r_i then becomes r_i +
// J_r(r_i)^-1 u_i with
//     u_i = delta_i - Ad(x_i^-1 x_{i-1}) delta_{i-1},     u_i ~ N(-r_i, Q_i),  Q_i = J_r(r_i)
//     Sigma_i J_r(r_i)^T
// (J_r(r) r = r). Seen from the stretch's first pose a, eta_i = Ad(x_a^-1 x_i) delta_i is a random
// walk:
//     eta_i = eta_{i-1} + Ad(x_a^-1 x_i) u_i.
// So the stretch a..b is one edge, eta_b - delta_a ~ N(drift, S) with drift and S the sums over its
// steps, and given its ends, lambda = S^-1 (eta_b - delta_a - drift), each step is u_i = -r_i + Q_i
// Ad(x_a^-1 x_i)^T lambda.
#include "overtone/core/synchronization/chain_smoother.h"

#include <algorithm>
#include <cmath>

#include "Eigen/SparseCholesky"
#include "absl/status/status.h"
#include "overtone/core/common/status_macros.h"

namespace overtone {
namespace {

using SparseMatrix = Eigen::SparseMatrix<double>;
using Steps = std::vector<Vector6d, Eigen::aligned_allocator<Vector6d>>;

// J_r(r) = sum_k (-ad r)^k / (k + 1)! = [X, Y; 0, X], the inverse of InverseRightJacobian.
Matrix6d RightJacobian(const Vector6d& r) {
  constexpr double kSmall = 0.03;  // where the fourth power, 7e-9, may be left out: nearly always
  Matrix6d jacobian = Matrix6d::Zero();
  Eigen::Matrix3d x, y;
  if (r.squaredNorm() < kSmall * kSmall) {
    const Eigen::Matrix3d p = Skew(r.tail<3>()), q = Skew(r.head<3>());
    const Eigen::Matrix3d pp = p * p, pq_qp = p * q + q * p;
    x = Eigen::Matrix3d::Identity() - p / 2 + pp / 6 - p * pp / 24;
    y = -q / 2 + pq_qp / 6 - (p * pq_qp + q * pp) / 24;
  } else {
    const Matrix6d inverse = InverseRightJacobian(r);
    x = inverse.topLeftCorner<3, 3>().inverse();
    y = -x * inverse.topRightCorner<3, 3>() * x;
  }
  jacobian.topLeftCorner<3, 3>() = x;
  jacobian.topRightCorner<3, 3>() = y;
  jacobian.bottomRightCorner<3, 3>() = x;
  return jacobian;
}

struct Stretch {
  int begin = 0;  // chord ends: poses of the chain
  int end = 0;
  Rigid3d begin_from_end;
  Vector6d drift = Vector6d::Zero();
  Matrix6d information = Matrix6d::Zero();  // S^-1
  Vector6d lambda = Vector6d::Zero();
};

class ChainSmoother {
 public:
  ChainSmoother(const std::vector<Rigid3d>& poses, const std::vector<OdometryStep>& odometry,
                const std::vector<Chord>& chords);

  // Sums up the stretches at the current poses; returns the cost.
  double Linearise();
  // Solves for the ends and spreads the result; returns by how much the linearised cost falls.
  absl::StatusOr<double> Solve();
  // Moves the poses by `share` of the solution, from where Linearise was last called.
  void Step(double share);

  std::vector<Rigid3d>& poses() { return poses_; }
  int64_t factor_nonzeros() const { return factor_nonzeros_; }

 private:
  int EndOf(int pose) const {
    return static_cast<int>(std::lower_bound(ends_.begin(), ends_.end(), pose) - ends_.begin());
  }
  double Condense(Stretch& stretch);
  void Spread(const Stretch& stretch);

  std::vector<Rigid3d> poses_;
  const std::vector<OdometryStep>& odometry_;
  const std::vector<Chord>& chords_;
  std::vector<int> ends_;  // increasing; ends_[0] is the fixed first pose
  std::vector<Stretch> stretches_;
  int64_t factor_nonzeros_ = 0;  // of the last solve
  // Per pose, at the last linearisation; unused behind the last end.
  std::vector<Rigid3d> previous_from_this_;
  Steps residual_;
  std::vector<Matrix6d, Eigen::aligned_allocator<Matrix6d>> step_covariance_;  // Q
  Steps step_;                                                                 // u
};

ChainSmoother::ChainSmoother(const std::vector<Rigid3d>& poses,
                             const std::vector<OdometryStep>& odometry,
                             const std::vector<Chord>& chords)
    : poses_(poses),
      odometry_(odometry),
      chords_(chords),
      ends_{0},
      previous_from_this_(poses.size()),
      residual_(poses.size()),
      step_covariance_(poses.size()),
      step_(poses.size()) {
  for (const Chord& chord : chords) {
    ends_.push_back(chord.from);
    ends_.push_back(chord.to);
  }
  std::sort(ends_.begin(), ends_.end());
  ends_.erase(std::unique(ends_.begin(), ends_.end()), ends_.end());
  for (int k = 1; k < ends_.size(); ++k) {
    stretches_.emplace_back();
    stretches_.back().begin = ends_[k - 1];
    stretches_.back().end = ends_[k];
  }
}

double ChainSmoother::Linearise() {
  double cost = 0;
  for (Stretch& stretch : stretches_) cost += Condense(stretch);
  for (const Chord& chord : chords_) {
    const Vector6d r =
        Log(chord.from_tform_to.Inverse() * (poses_[chord.from].Inverse() * poses_[chord.to]));
    cost += 0.5 * r.dot(chord.information * r);
  }
  return cost;
}

double ChainSmoother::Condense(Stretch& stretch) {
  double cost = 0;
  Rigid3d begin_from_this;
  Matrix6d covariance = Matrix6d::Zero();
  stretch.drift.setZero();
  for (int i = stretch.begin + 1; i <= stretch.end; ++i) {
    const OdometryStep& odometry = odometry_[i];
    previous_from_this_[i] = poses_[i - 1].Inverse() * poses_[i];
    begin_from_this = begin_from_this * previous_from_this_[i];
    const Vector6d r = Log(odometry.previous_from_this.Inverse() * previous_from_this_[i]);
    residual_[i] = r;
    cost += 0.5 * r.dot(odometry.information * r);
    const Matrix6d jacobian = RightJacobian(r);
    step_covariance_[i].noalias() = jacobian * odometry.covariance * jacobian.transpose();
    const Matrix6d adjoint = Adjoint(begin_from_this);
    stretch.drift -= adjoint * r;
    covariance.noalias() += adjoint * step_covariance_[i] * adjoint.transpose();
  }
  stretch.begin_from_end = begin_from_this;
  stretch.information = covariance.llt().solve(Matrix6d::Identity());
  return cost;
}

absl::StatusOr<double> ChainSmoother::Solve() {
  // Normal equations over the ends but the first. Lower triangle only.
  const int size = 6 * static_cast<int>(stretches_.size());
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(36 * 3 * (stretches_.size() + chords_.size()));
  Eigen::VectorXd right_side = Eigen::VectorXd::Zero(size);
  const auto add_block = [&entries](int row, int column, const Matrix6d& block) {
    if (row < 0 || column < 0 || row < column) return;
    for (int j = 0; j < 6; ++j) {
      for (int i = 0; i < 6; ++i) entries.emplace_back(6 * row + i, 6 * column + j, block(i, j));
    }
  };
  // Adds |error + from_jacobian delta_from + to_jacobian delta_to|^2_information; -1 is the fixed
  // pose.
  const auto add_edge = [&](int from, int to, const Matrix6d& from_jacobian,
                            const Matrix6d& to_jacobian, const Vector6d& error,
                            const Matrix6d& information) {
    const Matrix6d weighted_from = from_jacobian.transpose() * information;
    const Matrix6d weighted_to = to_jacobian.transpose() * information;
    add_block(from, from, weighted_from * from_jacobian);
    add_block(to, to, weighted_to * to_jacobian);
    add_block(from, to, weighted_from * to_jacobian);
    add_block(to, from, weighted_to * from_jacobian);
    if (from >= 0) right_side.segment<6>(6 * from) -= weighted_from * error;
    if (to >= 0) right_side.segment<6>(6 * to) -= weighted_to * error;
  };
  for (int k = 0; k < stretches_.size(); ++k) {
    const Stretch& stretch = stretches_[k];
    add_edge(k - 1, k, -Matrix6d::Identity(), Adjoint(stretch.begin_from_end), -stretch.drift,
             stretch.information);
  }
  for (const Chord& chord : chords_) {
    const Rigid3d from_tform_to = poses_[chord.from].Inverse() * poses_[chord.to];
    const Vector6d r = Log(chord.from_tform_to.Inverse() * from_tform_to);
    const Matrix6d jacobian = InverseRightJacobian(r);
    add_edge(EndOf(chord.from) - 1, EndOf(chord.to) - 1,
             -jacobian * Adjoint(from_tform_to.Inverse()), jacobian, r, chord.information);
  }
  if (size == 0) return 0;
  SparseMatrix hessian(size, size);
  hessian.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLLT<SparseMatrix, Eigen::Lower> solver(hessian);
  if (solver.info() != Eigen::Success) return absl::InternalError("chain: factorisation failed");
  factor_nonzeros_ = SparseMatrix(solver.matrixL()).nonZeros();
  const Eigen::VectorXd delta = solver.solve(right_side);
  if (!delta.allFinite()) return absl::InternalError("chain: the solution is not finite");

  for (int k = 0; k < stretches_.size(); ++k) {
    Stretch& stretch = stretches_[k];
    const Vector6d begin = k == 0 ? Vector6d::Zero() : Vector6d(delta.segment<6>(6 * (k - 1)));
    const Vector6d end = Adjoint(stretch.begin_from_end) * delta.segment<6>(6 * k);
    stretch.lambda = stretch.information * (end - begin - stretch.drift);
    Spread(stretch);
  }
  return 0.5 * delta.dot(right_side);
}

void ChainSmoother::Spread(const Stretch& stretch) {
  // lambda as seen from each pose in turn: Ad(x_a^-1 x_i)^T lambda.
  Vector6d lambda = stretch.lambda;
  for (int i = stretch.begin + 1; i <= stretch.end; ++i) {
    lambda = Adjoint(previous_from_this_[i]).transpose() * lambda;
    step_[i] = step_covariance_[i] * lambda - residual_[i];
  }
}

void ChainSmoother::Step(double share) {
  for (int i = 1; i <= ends_.back(); ++i) {
    poses_[i] = poses_[i - 1] * (previous_from_this_[i] * Exp(share * step_[i]));
  }
  for (int i = ends_.back() + 1; i < poses_.size(); ++i) {
    poses_[i] = poses_[i - 1] * odometry_[i].previous_from_this;
  }
}

}  // namespace

absl::StatusOr<ChainSmootherResult> SmoothChain(const std::vector<Rigid3d>& poses,
                                                const std::vector<OdometryStep>& odometry,
                                                const std::vector<Chord>& chords,
                                                const ChainSmootherOptions& options) {
  constexpr double kSmallestShare = 1e-3;
  ChainSmootherResult result;
  ChainSmoother smoother(poses, odometry, chords);
  result.initial_cost = result.final_cost = smoother.Linearise();
  while (!result.converged && result.iterations < options.max_iterations) {
    ++result.iterations;
    ASSIGN_OR_RETURN(const double promised, smoother.Solve());
    smoother.Step(1);
    result.converged = promised <= options.cost_tolerance;
    if (result.converged) break;
    double cost = smoother.Linearise();
    // Too far: halfway back, and again.
    for (double share = 1; !(cost <= result.final_cost) && share > kSmallestShare; share /= 2) {
      smoother.Step(-share / 2);
      cost = smoother.Linearise();
    }
    if (!(cost <= result.final_cost)) return absl::InternalError("chain: the cost does not fall");
    result.final_cost = cost;
  }
  result.factor_nonzeros = smoother.factor_nonzeros();
  result.poses = std::move(smoother.poses());
  return result;
}

}  // namespace overtone
