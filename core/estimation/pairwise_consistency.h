// SPDX-License-Identifier: Apache-2.0
// Which of the loop closures between two missions to believe: the largest set in which every two
// agree. Mangelson, Dominic, Eustice & Vasudevan, "Pairwise Consistent Measurement Set Maximization
// for Robust Multi-robot Map Merging", ICRA 2018 (PCM).
//
// Two closures z_ij and z_kl, from poses i, k of mission a to poses j, l of mission b, close a loop
// with the odometry between them,
//
//     e = Log(z_ij^-1 * a_ik * z_kl * b_lj),
//
// which is 0 up to the noise of its four parts. They agree when e^T Sigma^-1 e, with Sigma
// propagated to first order, is within a chi-square limit. Which frames the missions are in does
// not matter, so none need be known.
#ifndef OVERTONE_CORE_ESTIMATION_PAIRWISE_CONSISTENCY_H_
#define OVERTONE_CORE_ESTIMATION_PAIRWISE_CONSISTENCY_H_

#include <vector>

#include "absl/status/status.h"
#include "overtone/core/estimation/maximum_clique.h"
#include "overtone/core/estimation/uncertain_trajectory.h"

namespace overtone {

struct InterMissionClosure {
  int from = 0;  // position in mission a
  int to = 0;    // position in mission b
  Rigid3d from_tform_to;
  Matrix6d covariance = Matrix6d::Identity();  // right tangent of from_tform_to
};

// e^T Sigma^-1 e of the loop above. Positions within range, covariances positive definite.
// Exchanging the closures gives the same up to terms of the order of e.
double ConsistencyChiSquare(const InterMissionClosure& ij, const InterMissionClosure& kl,
                            const UncertainTrajectory& a, const UncertainTrajectory& b);

struct PairwiseConsistencyOptions {
  // 6 degrees of freedom, exceeded once in a million. Wider than the quantile for a single test: n
  // right closures make n^2 / 2 pairs, and one pair that fails costs a closure. It also leaves room
  // for odometry that is a third less certain than it says (sigma times 1.3 at 99.9 %). Wrong
  // closures miss by metres and lose little by it.
  double chi_square_limit = 38.26;
  CliqueOptions clique;

  absl::Status Validate() const;
};

// Of the closures between one pair of missions. Not thread-safe. The trajectories are given with
// each call: what is compared against them is computed once, when a closure arrives.
class PairwiseConsistency {
 public:
  // options: valid.
  explicit PairwiseConsistency(const PairwiseConsistencyOptions& options) : options_(options) {}

  // Compares with the n closures before it, O(n). Its number is the one after the last.
  // InvalidArgument, and nothing is added: position out of range, covariance not positive definite.
  absl::Status Add(const InterMissionClosure& closure, const UncertainTrajectory& a,
                   const UncertainTrajectory& b);

  // Compares all anew, O(n^2): the trajectories have changed.
  void Rebuild(const UncertainTrajectory& a, const UncertainTrajectory& b);

  // The numbers of the closures to believe. At no cost when nothing was added since the last time;
  // after k additions to a proven set, k searches among what agrees with each new closure. Of
  // equally large sets the one that keeps what was believed before.
  const Clique& ConsistentSet();

  int Size() const { return static_cast<int>(closures_.size()); }
  bool Agree(int k, int l) const { return graph_.AreConnected(k, l); }

 private:
  void Compare(int k, const UncertainTrajectory& a, const UncertainTrajectory& b);

  PairwiseConsistencyOptions options_;
  std::vector<InterMissionClosure> closures_;
  BitGraph graph_;
  Clique set_;  // of the first num_searched_ closures
  int num_searched_ = 0;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_PAIRWISE_CONSISTENCY_H_
