// SPDX-License-Identifier: Apache-2.0
// A stretch of poses that only odometry ties, each to the next: what it says about its two ends,
// and where its poses lie between them. So an optimiser need not see them at all.
//
// The motions Y_k = T_{k-1}^-1 T_k, measured as Z_k with covariance C_k, make up the relative pose
// of the ends R = Y_1 ... Y_n. With e_k = Log(Z_k^-1 Y_k) and B_k = Ad(T_n^-1 T_k) Jr(e_k), moving
// the errors to e_k + u_k moves R to R Exp(sum B_k u_k), to first order. With s = sum B_k e_k and
// S = sum B_k C_k B_k^T, the least cost of the stretch with its ends at R Exp(d) is
//
//     (s + d)^T S^-1 (s + d)      at errors  C_k B_k^T S^-1 (s + d):
//
// one edge, which measures R Exp(-s). It has the stretch's own cost and gradient where the poses
// between are the best for the ends, and is as good elsewhere as one linearisation is. On
// undisturbed odometry S is the covariance of uncertain_trajectory.h.
#ifndef OVERTONE_CORE_ESTIMATION_CHAIN_RELAXATION_H_
#define OVERTONE_CORE_ESTIMATION_CHAIN_RELAXATION_H_

#include <vector>

#include "overtone/core/common/block_vector.h"
#include "overtone/core/geometry/packed_covariance.h"
#include "overtone/core/geometry/se3.h"

namespace overtone {

struct ChainMotion {
  Rigid3d previous_from_this;
  PackedCovariance covariance;  // right tangent, positive definite
};
// motions[k] leads from pose k - 1 to pose k; motions[0] counts for nothing.
using ChainMotions = BlockVector<ChainMotion>;

struct CompoundMotion {
  Rigid3d first_from_last;
  Matrix6d information = Matrix6d::Identity();  // right tangent of first_from_last
  double chi_square = 0;  // of the motions, at the poses: what the edge says at these ends
  bool converged = false;
};

// Moves the poses between `first` and `last` (< poses.size(), above first) to where the motions
// between the two have the least cost, by Gauss-Newton, and gives the edge that stands for them.
// O(last - first). Where it does not converge (ends torn metres apart) the poses are the best it
// came upon, and chi_square is still theirs.
CompoundMotion RelaxChain(const ChainMotions& motions, int first, int last,
                          std::vector<Rigid3d>& poses);

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_CHAIN_RELAXATION_H_
