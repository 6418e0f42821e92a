// SPDX-License-Identifier: Apache-2.0
// The most likely poses of a graph of relative measurements: min sum w_k |Log(Z_k^-1 T_i^-1
// T_j)|^2_Omega_k, by Levenberg-Marquardt on SE(3) with sparse Cholesky (Ceres, SuiteSparse).
#ifndef OVERTONE_CORE_ESTIMATION_POSE_GRAPH_OPTIMIZER_H_
#define OVERTONE_CORE_ESTIMATION_POSE_GRAPH_OPTIMIZER_H_

#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/estimation/robust_loss.h"
#include "overtone/core/graph/pose_graph.h"

namespace overtone {

enum class PoseGraphInitialisation {
  kGiven,         // the graph's own poses
  kSpanningTree,  // odometry composed from each component's first pose
  kChordal,       // rotation relaxation, then translations
};

struct PoseGraphOptimizerOptions {
  PoseGraphInitialisation initialisation = PoseGraphInitialisation::kGiven;
  // Applies to loop closures; odometry is trusted.
  RobustLoss loss = RobustLoss::kNone;
  // The robust loss's limit on a closure's weighted squared residual: the chi-square quantile of 6
  // degrees of freedom at 99.9 %.
  double closure_chi_square_limit = 22.46;
  // Graduated losses: what is known from an earlier run, 0 or 1 for each edge. Empty: 1 for all.
  std::vector<double> initial_weights;
  // Of one solve; graduated losses make several.
  int max_iterations = 100;
  // Stops when an iteration lowers the cost by less than this share of it.
  double function_tolerance = 1e-10;
  int num_threads = 1;

  absl::Status Validate() const;
};

struct PoseGraphResult {
  std::vector<Rigid3d> poses;
  double initial_cost = 0;  // 1/2 sum of weighted squared residuals, after initialisation
  double final_cost = 0;
  bool converged = false;
  int iterations = 0;
  double seconds = 0;               // wall time, initialisation included
  double initialisation_s = 0;      // its part
  std::vector<double> weights;      // one for each edge, [0, 1]
  std::vector<double> chi_squares;  // one for each edge: |r|^2 at the result, unweighted
  int number_of_components =
      0;  // one pose of each, that of smallest index, stays as it was initialised
};

// InvalidArgument, naming the pose or edge: not finite, quaternion not of unit length, index out of
// range, both ends the same, information not symmetric positive semi-definite.
absl::Status CheckPoseGraph(const PoseGraph& graph);

// InvalidArgument as by CheckPoseGraph and Validate; FailedPrecondition as by
// ChordalInitialisation. Deterministic with one thread.
absl::StatusOr<PoseGraphResult> OptimizePoseGraph(const PoseGraph& graph,
                                                  const PoseGraphOptimizerOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_POSE_GRAPH_OPTIMIZER_H_
