// SPDX-License-Identifier: Apache-2.0
// Least squares in spite of wrong loop closures and sightings: graduated non-convexity (GNC). Yang,
// Antonante, Tzoumas & Carlone, RA-L 5(2), 2020: solve with weights, set each doubtful
// measurement's weight from its residual, make the surrogate less convex, repeat. Odometry is
// trusted and keeps weight 1. Residuals count in units of the limit of their kind, so that one
// schedule serves all kinds.
#ifndef OVERTONE_CORE_ESTIMATION_GRADUATED_NON_CONVEXITY_H_
#define OVERTONE_CORE_ESTIMATION_GRADUATED_NON_CONVEXITY_H_

#include <vector>

#include "overtone/core/estimation/pose_graph_problem.h"

namespace overtone {

struct GncOptions {
  RobustLoss loss = RobustLoss::kTruncatedLeastSquares;  // or kGemanMcClure
  // Of mu from step to step. The paper has 1.4; with 4 the soft weights, which go with the root of
  // mu, double at each step, and a quarter of the steps gives the same verdicts.
  double factor = 4;
  int max_steps = 100;
};

// Minimises over the estimate and the weights. `doubtful` are the measurements that may be wrong,
// `initial_weights` (one for each, 0 or 1) what an earlier run found. The schedule runs only when
// needed: if after a plain solve with the initial weights every measurement in use fits and every
// one left out does not, that is already a stationary point of the truncated cost, and it is kept.
// The initial cost is that of the initial weights, the final cost that of the final ones.
SolveSummary SolveGraduated(const std::vector<int>& doubtful,
                            const std::vector<double>& initial_weights, const GncOptions& options,
                            const SolveLimits& limits, PoseGraphProblem& problem);

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_GRADUATED_NON_CONVEXITY_H_
