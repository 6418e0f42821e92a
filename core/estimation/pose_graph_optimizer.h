// SPDX-License-Identifier: Apache-2.0
// The most likely poses and landmarks of a graph of relative measurements:
//
//     min sum w_k |Log(Z_k^-1 T_i^-1 T_j)|^2_Omega_k + sum w_l |T_i^-1 p - z_l|^2_Omega_l
//
// over its edges and its point sightings (relative_pose_error.h, point_sighting_error.h), by
// Levenberg-Marquardt on SE(3) with sparse Cholesky (Ceres, SuiteSparse).
#ifndef OVERTONE_CORE_ESTIMATION_POSE_GRAPH_OPTIMIZER_H_
#define OVERTONE_CORE_ESTIMATION_POSE_GRAPH_OPTIMIZER_H_

#include <atomic>
#include <vector>

#include "absl/status/status.h"
#include "absl/status/statusor.h"
#include "overtone/core/estimation/robust_loss.h"
#include "overtone/core/graph/pose_graph.h"

namespace overtone {

// The latter two see edges only: what sightings alone tie stays apart, each part where its first
// pose was given. Then every landmark moves into the middle of where its sightings see it.
enum class PoseGraphInitialisation {
  kGiven,         // the graph's own poses and landmarks
  kSpanningTree,  // odometry composed from each component's first pose
  kChordal,       // rotation relaxation, then translations
};

struct PoseGraphOptimizerOptions {
  PoseGraphInitialisation initialisation = PoseGraphInitialisation::kGiven;
  // Applies to loop closures and sightings; odometry is trusted.
  RobustLoss loss = RobustLoss::kNone;
  // The robust loss's limit on a closure's weighted squared residual: the chi-square quantile of 6
  // degrees of freedom at 99.9 %.
  double closure_chi_square_limit = 22.46;
  // The same for sightings, with 3 degrees of freedom.
  double sighting_chi_square_limit = 16.27;
  // Graduated losses: what is known from an earlier run, 0 or 1 for each edge and each sighting.
  // Empty: 1 for all.
  std::vector<double> initial_weights;
  std::vector<double> initial_sighting_weights;
  // Of one solve; graduated losses make several.
  int max_iterations = 100;
  // Stops when an iteration lowers the cost by less than this share of it.
  double function_tolerance = 1e-10;
  int num_threads = 1;
  // One for each pose, then one for each landmark: stays where it is. Empty: none. A component that
  // has such a pose is held by it.
  std::vector<bool> held;
  // Read between iterations, from whichever thread sets it: true ends the run. Null: nothing does.
  const std::atomic<bool>* give_up = nullptr;

  absl::Status Validate() const;
};

struct PoseGraphResult {
  std::vector<Rigid3d> poses;
  std::vector<Eigen::Vector3d> landmarks;  // unseen ones stay where they lost their last sighting
  double initial_cost = 0;  // 1/2 sum of weighted squared residuals, after initialisation
  double final_cost = 0;
  bool converged = false;
  int iterations = 0;
  double seconds = 0;                        // wall time, initialisation included
  double initialisation_s = 0;               // its part
  std::vector<double> weights;               // one for each edge, [0, 1]
  std::vector<double> chi_squares;           // one for each edge: |r|^2 at the result, unweighted
  std::vector<double> sighting_weights;      // one for each sighting
  std::vector<double> sighting_chi_squares;  // one for each sighting
  // Tied by edges or sightings. One pose of each, that of smallest index, stays as it was
  // initialised.
  int number_of_components = 0;
};

// InvalidArgument as by CheckPoseGraph (pose_graph_check.h) and Validate; FailedPrecondition as by
// ChordalInitialisation; Cancelled when it was given up. Parts tied by too few sightings to be
// rigid (one common landmark) keep the motion these leave open near where it began. Deterministic
// with one thread.
absl::StatusOr<PoseGraphResult> OptimizePoseGraph(const PoseGraph& graph,
                                                  const PoseGraphOptimizerOptions& options);

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_POSE_GRAPH_OPTIMIZER_H_
