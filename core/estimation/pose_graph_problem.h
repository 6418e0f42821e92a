// SPDX-License-Identifier: Apache-2.0
// A pose graph as a Ceres problem: one block for each pose, one residual for each edge. Loop
// closures carry a weight that may be changed between solves. Every solve holds one pose of each
// connected component (over the edges of weight above 0), the one of smallest index: nothing
// measures where a component is, so without it the problem is singular.
#ifndef OVERTONE_CORE_ESTIMATION_POSE_GRAPH_PROBLEM_H_
#define OVERTONE_CORE_ESTIMATION_POSE_GRAPH_PROBLEM_H_

#include <deque>
#include <memory>
#include <vector>

#include "ceres/problem.h"
#include "overtone/core/estimation/relative_pose_error.h"
#include "overtone/core/estimation/robust_loss.h"
#include "overtone/core/graph/pose_graph.h"

namespace overtone {

struct SolveLimits {
  int max_iterations = 0;
  double function_tolerance = 0;  // relative decrease of the cost
  int num_threads = 1;
};

struct SolveSummary {
  double initial_cost = 0;
  double final_cost = 0;
  int iterations = 0;
  bool converged = false;
};

// Not thread-safe. `graph` must outlive it and have passed CheckPoseGraph.
class PoseGraphProblem {
 public:
  // square_root_information: one for each edge. loss: of the loop closures; graduated ones start at
  // weight 1.
  PoseGraphProblem(const PoseGraph& graph, const std::vector<Matrix6d>& square_root_information,
                   RobustLoss loss, double squared_limit);

  // Minimises from the present poses. Never fails outright: a solver that cannot go on leaves the
  // best poses so far.
  SolveSummary Solve(const SolveLimits& limits);

  // Scales the cost of loop closure `edge`. [0, 1]
  void SetWeight(int edge, double weight);
  // |r|^2 of an edge at the present poses, unweighted.
  double ChiSquare(int edge) const;
  // The weight an edge has at the present poses: that of SetWeight or the derivative of its loss.
  double Weight(int edge) const;

  void SetPoses(const std::vector<Rigid3d>& poses);
  std::vector<Rigid3d> Poses() const;

 private:
  void HoldOnePosePerComponent();

  const PoseGraph& graph_;
  const std::unique_ptr<ceres::LossFunction> loss_;
  PoseManifold manifold_;
  std::vector<double> blocks_;            // kPoseBlockSize for each pose
  std::deque<RelativePoseError> errors_;  // the problem keeps pointers into it
  std::vector<double> weights_;
  std::vector<bool> held_;
  std::vector<std::unique_ptr<ceres::LossFunctionWrapper>> scales_;  // null for odometry
  std::unique_ptr<ceres::Problem> problem_;                          // last: refers to the others
};

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_POSE_GRAPH_PROBLEM_H_
