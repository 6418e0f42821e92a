// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/chain_relaxation.h"

#include <algorithm>

#include "Eigen/Cholesky"
#include "Eigen/LU"

namespace overtone {
namespace {

constexpr int kMaxIterations = 30;
// Of the chi square: what another iteration may still gain.
constexpr double kTolerance = 1e-8;

// One motion at the present poses.
struct MotionError {
  Vector6d error;           // e
  Matrix6d right_jacobian;  // Jr(e)
  Matrix6d to_last;         // B
  Matrix6d covariance;      // C
};

struct Linearisation {
  std::vector<MotionError> motions;
  Vector6d sum = Vector6d::Zero();         // s
  Matrix6d covariance = Matrix6d::Zero();  // S
  double chi_square = 0;
};

// Jr(xi), Barfoot 7.76. Most errors are tiny: their series ends after the cube (to 1e-9).
Matrix6d RightJacobian(const Vector6d& xi) {
  constexpr double kTiny = 0.02;
  if (!(xi.norm() < kTiny)) return InverseRightJacobian(xi).inverse();
  Matrix6d ad = Matrix6d::Zero();
  ad.topLeftCorner<3, 3>() = ad.bottomRightCorner<3, 3>() = Skew(xi.tail<3>());
  ad.topRightCorner<3, 3>() = Skew(xi.head<3>());
  const Matrix6d square = ad * ad;
  return Matrix6d::Identity() - ad / 2 + square / 6 - square * ad / 24;
}

MotionError ErrorOf(const ChainMotion& motion, const Rigid3d& previous, const Rigid3d& pose,
                    const Rigid3d& last_from_world) {
  MotionError result;
  result.error = Log(motion.previous_from_this.Inverse() * (previous.Inverse() * pose));
  result.right_jacobian = RightJacobian(result.error);
  result.to_last = Adjoint(last_from_world * pose) * result.right_jacobian;
  result.covariance = motion.covariance.Unpacked();
  return result;
}

Linearisation Linearise(const ChainMotions& motions, int first, int last,
                        const std::vector<Rigid3d>& poses) {
  Linearisation result;
  result.motions.reserve(last - first);
  const Rigid3d last_from_world = poses[last].Inverse();
  for (int k = first + 1; k <= last; ++k) {
    const MotionError& motion =
        result.motions.emplace_back(ErrorOf(motions[k], poses[k - 1], poses[k], last_from_world));
    result.sum += motion.to_last * motion.error;
    result.covariance.noalias() += motion.to_last * motion.covariance * motion.to_last.transpose();
    result.chi_square += motion.error.dot(motion.covariance.llt().solve(motion.error));
  }
  return result;
}

// Moves the poses a share of the way to the errors C B^T pull.
void Step(const Linearisation& at, const Vector6d& pull, double share, int first, int last,
          std::vector<Rigid3d>& poses) {
  Rigid3d pose = poses[first], previous = poses[first];
  for (int k = first + 1; k < last; ++k) {
    const MotionError& motion = at.motions[k - first - 1];
    const Vector6d error = motion.covariance * (motion.to_last.transpose() * pull);
    const Rigid3d moved = previous.Inverse() * poses[k];
    previous = poses[k];
    pose = pose * moved * Exp(share * (motion.right_jacobian * (error - motion.error)));
    poses[k] = pose;
  }
}

CompoundMotion EdgeOf(const Linearisation& at, const Rigid3d& first_from_last) {
  CompoundMotion edge;
  edge.chi_square = at.chi_square;
  edge.first_from_last = first_from_last * Exp(-at.sum);
  // The residual of an edge is Log(Exp(s) Exp(d)): so that its gradient is that of s + d, Jr(s).
  const Matrix6d jacobian = RightJacobian(at.sum);
  const Matrix6d information =
      jacobian.transpose() * at.covariance.llt().solve(Matrix6d::Identity()) * jacobian;
  edge.information = 0.5 * (information + information.transpose());
  return edge;
}

}  // namespace

CompoundMotion RelaxChain(const ChainMotions& motions, int first, int last,
                          std::vector<Rigid3d>& poses) {
  const auto begin = poses.begin() + first, end = poses.begin() + last + 1;
  Linearisation at = Linearise(motions, first, last, poses);
  double share = 1;
  bool converged = false;
  for (int iteration = 0; iteration < kMaxIterations; ++iteration) {
    const Vector6d pull = at.covariance.llt().solve(at.sum);
    const double best = at.sum.dot(pull);
    converged = !(at.chi_square - best > kTolerance * (1 + at.chi_square));
    if (converged) break;
    const std::vector<Rigid3d> before(begin, end);
    Step(at, pull, share, first, last, poses);
    Linearisation next = Linearise(motions, first, last, poses);
    if (next.chi_square < at.chi_square) {
      at = std::move(next);
      share = std::min(1.0, 2 * share);
    } else {
      std::copy(before.begin(), before.end(), begin);
      share /= 2;
    }
  }
  CompoundMotion edge = EdgeOf(at, poses[first].Inverse() * poses[last]);
  edge.converged = converged;
  return edge;
}

}  // namespace overtone
