// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/chain_smoother.h"

#include <algorithm>
#include <utility>

#include "absl/status/status.h"
#include "overtone/core/common/status_macros.h"
#include "overtone/core/synchronization/block_cholesky.h"
#include "overtone/core/synchronization/odometry_stretch.h"

namespace overtone {
namespace {

class ChainSmoother {
 public:
  ChainSmoother(const std::vector<Rigid3d>& poses, const std::vector<OdometryStep>& odometry,
                const std::vector<Chord>& chords);

  // Sums up the stretches at the current state; returns the cost.
  double Linearise();
  // Solves for the ends and spreads the result; returns by how much the linearised cost falls.
  absl::StatusOr<double> Solve();
  // Changes the steps by `share` of the solution.
  void Move(double share);

  std::vector<Rigid3d> Poses(const Rigid3d& first) const;
  int64_t FactorNonZeros() const;

 private:
  // A chord between the poses ends_[from] and ends_[to].
  struct EndChord {
    int from, to;
    const Chord* chord;
  };

  Vector6d Residual(const EndChord& c) const;
  void AddStretch(int k, Eigen::VectorXd& right_side);
  void AddChord(const EndChord& c, Eigen::VectorXd& right_side);

  const std::vector<OdometryStep>& odometry_;
  std::vector<int> ends_;                   // increasing; ends_[0] is the fixed first pose
  std::vector<OdometryStretch> stretches_;  // k: from ends_[k] to ends_[k + 1]
  std::vector<EndChord> chords_;
  std::vector<StepState> steps_;    // per pose up to the last end; [0] is not used
  std::vector<Rigid3d> end_poses_;  // seen from the first
  BlockCholesky normal_equations_;  // over the ends but the first
};

std::vector<int> Ends(const std::vector<Chord>& chords) {
  std::vector<int> ends = {0};
  for (const Chord& chord : chords) ends.insert(ends.end(), {chord.from, chord.to});
  std::sort(ends.begin(), ends.end());
  ends.erase(std::unique(ends.begin(), ends.end()), ends.end());
  return ends;
}

// Which rows of the normal equations neighbouring ends and chords couple.
std::vector<std::pair<int, int>> Couplings(const std::vector<int>& ends,
                                           const std::vector<Chord>& chords) {
  std::vector<std::pair<int, int>> couplings;
  const auto row_of = [&ends](int pose) {
    return static_cast<int>(std::lower_bound(ends.begin(), ends.end(), pose) - ends.begin()) - 1;
  };
  for (int k = 2; k < ends.size(); ++k) couplings.emplace_back(k - 2, k - 1);
  for (const Chord& chord : chords) {
    const int from = row_of(chord.from), to = row_of(chord.to);
    if (from >= 0 && to >= 0) couplings.emplace_back(from, to);
  }
  return couplings;
}

ChainSmoother::ChainSmoother(const std::vector<Rigid3d>& poses,
                             const std::vector<OdometryStep>& odometry,
                             const std::vector<Chord>& chords)
    : odometry_(odometry),
      ends_(Ends(chords)),
      steps_(ends_.back() + 1),
      end_poses_(ends_.size()),
      normal_equations_(static_cast<int>(ends_.size()) - 1, Couplings(ends_, chords)) {
  const auto end_of = [this](int pose) {
    return static_cast<int>(std::lower_bound(ends_.begin(), ends_.end(), pose) - ends_.begin());
  };
  for (const Chord& chord : chords) {
    chords_.push_back({end_of(chord.from), end_of(chord.to), &chord});
  }
  for (int k = 1; k < ends_.size(); ++k) {
    stretches_.emplace_back();
    stretches_.back().begin = ends_[k - 1];
    stretches_.back().end = ends_[k];
  }
  for (int i = 1; i < steps_.size(); ++i) {
    steps_[i].error =
        Log(odometry[i].previous_from_this.Inverse() * (poses[i - 1].Inverse() * poses[i]));
  }
}

double ChainSmoother::Linearise() {
  double cost = 0;
  for (int k = 0; k < stretches_.size(); ++k) {
    cost += stretches_[k].Condense(odometry_, steps_);
    end_poses_[k + 1] = end_poses_[k] * stretches_[k].begin_from_end;
  }
  for (const EndChord& c : chords_) {
    const Vector6d r = Residual(c);
    cost += 0.5 * r.dot(c.chord->information * r);
  }
  return cost;
}

Vector6d ChainSmoother::Residual(const EndChord& c) const {
  return Log(c.chord->from_tform_to.Inverse() * (end_poses_[c.from].Inverse() * end_poses_[c.to]));
}

absl::StatusOr<double> ChainSmoother::Solve() {
  normal_equations_.SetZero();
  Eigen::VectorXd right_side = Eigen::VectorXd::Zero(6 * stretches_.size());
  for (int k = 0; k < stretches_.size(); ++k) AddStretch(k, right_side);
  for (const EndChord& c : chords_) AddChord(c, right_side);
  if (!normal_equations_.Factorise()) return absl::InternalError("chain: factorisation failed");
  const Eigen::VectorXd moves = normal_equations_.Solve(right_side);
  if (!moves.allFinite()) return absl::InternalError("chain: the solution is not finite");
  Vector6d begin_moves = Vector6d::Zero();
  for (int k = 0; k < stretches_.size(); ++k) {
    const Vector6d end_moves = moves.segment<6>(6 * k);
    stretches_[k].Spread(begin_moves, end_moves, odometry_, steps_);
    begin_moves = end_moves;
  }
  return 0.5 * moves.dot(right_side);
}

// |Ad(begin_from_end) delta_end - delta_begin - drift|^2 in the stretch's information.
void ChainSmoother::AddStretch(int k, Eigen::VectorXd& right_side) {
  const OdometryStretch& stretch = stretches_[k];
  const Matrix6d adjoint = Adjoint(stretch.begin_from_end);
  const Matrix6d weighted = stretch.information.lazyProduct(adjoint);
  normal_equations_.Add(k, k, adjoint.transpose().lazyProduct(weighted));
  const Vector6d pull = stretch.information * stretch.drift;
  right_side.segment<6>(6 * k) += adjoint.transpose() * pull;
  if (k == 0) return;
  normal_equations_.Add(k - 1, k - 1, stretch.information);
  normal_equations_.Add(k - 1, k, -weighted);
  right_side.segment<6>(6 * (k - 1)) -= pull;
}

// |r + J (delta_to - Ad(to_from_from) delta_from)|^2 in the chord's information.
void ChainSmoother::AddChord(const EndChord& c, Eigen::VectorXd& right_side) {
  const Vector6d r = Residual(c);
  const Matrix6d to = InverseRightJacobian(r);
  const Matrix6d from = -to.lazyProduct(Adjoint(end_poses_[c.to].Inverse() * end_poses_[c.from]));
  const Matrix6d weighted_to = c.chord->information.lazyProduct(to);
  const Matrix6d weighted_from = c.chord->information.lazyProduct(from);
  const int to_row = c.to - 1, from_row = c.from - 1;
  if (to_row >= 0) {
    normal_equations_.Add(to_row, to_row, to.transpose().lazyProduct(weighted_to));
    right_side.segment<6>(6 * to_row) -= weighted_to.transpose() * r;
  }
  if (from_row >= 0) {
    normal_equations_.Add(from_row, from_row, from.transpose().lazyProduct(weighted_from));
    right_side.segment<6>(6 * from_row) -= weighted_from.transpose() * r;
  }
  if (to_row >= 0 && from_row >= 0) {
    normal_equations_.Add(to_row, from_row, to.transpose().lazyProduct(weighted_from));
  }
}

void ChainSmoother::Move(double share) {
  for (StepState& step : steps_) step.error += share * step.change;
}

std::vector<Rigid3d> ChainSmoother::Poses(const Rigid3d& first) const {
  std::vector<Rigid3d> poses = {first};
  poses.reserve(odometry_.size());
  for (int i = 1; i < odometry_.size(); ++i) {
    Rigid3d previous_from_this = odometry_[i].previous_from_this;
    if (i < steps_.size()) previous_from_this = previous_from_this * Exp(steps_[i].error);
    poses.push_back(poses.back() * previous_from_this);
  }
  return poses;
}

// A pose inside a stretch is eliminated between its two ends, one that hangs on a single neighbour
// with that one.
int64_t ChainSmoother::FactorNonZeros() const {
  constexpr int kDiagonal = 21, kBlock = 36;
  int64_t count = normal_equations_.NumNonZeros();
  for (int k = 0; k < stretches_.size(); ++k) {
    const int64_t inside = stretches_[k].end - stretches_[k].begin - 1;
    count += inside * (kDiagonal + (k == 0 ? kBlock : 2 * kBlock));
  }
  const int64_t behind =
      static_cast<int64_t>(odometry_.size()) - static_cast<int64_t>(steps_.size());
  return count + behind * (kDiagonal + kBlock) - (ends_.size() == 1 && behind > 0 ? kBlock : 0);
}

}  // namespace

absl::StatusOr<ChainSmootherResult> SmoothChain(const std::vector<Rigid3d>& poses,
                                                const std::vector<OdometryStep>& odometry,
                                                const std::vector<Chord>& chords,
                                                const ChainSmootherOptions& options) {
  constexpr double kSmallestShare = 1e-3;
  constexpr double kRoundOff = 1e-13;  // of the cost
  ChainSmootherResult result;
  if (poses.empty()) {
    result.converged = true;
    return result;
  }
  ChainSmoother smoother(poses, odometry, chords);
  result.initial_cost = result.final_cost = smoother.Linearise();
  while (!result.converged && result.iterations < options.max_iterations) {
    ++result.iterations;
    ASSIGN_OR_RETURN(const double promised, smoother.Solve());
    smoother.Move(1);
    result.converged = promised <= std::max(options.cost_tolerance, kRoundOff * result.final_cost);
    if (result.converged) break;
    double cost = smoother.Linearise();
    // Too far: halfway back, and again.
    for (double share = 1; !(cost <= result.final_cost) && share > kSmallestShare; share /= 2) {
      smoother.Move(-share / 2);
      cost = smoother.Linearise();
    }
    if (!(cost <= result.final_cost)) return absl::InternalError("chain: the cost does not fall");
    result.final_cost = cost;
  }
  result.poses = smoother.Poses(poses.front());
  result.factor_non_zeros = smoother.FactorNonZeros();
  return result;
}

}  // namespace overtone
