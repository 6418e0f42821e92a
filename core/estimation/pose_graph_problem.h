// SPDX-License-Identifier: Apache-2.0
// A pose graph as a Ceres problem: one block for each pose and landmark, one residual for each edge
// and sighting. Loop closures and sightings carry a weight that may be changed between solves.
// Every solve holds one pose of each connected component (over the measurements of weight above 0),
// the one of smallest index: nothing measures where a component is, so without it the problem is
// singular. A component with poses that are to stay anyway has no need of another. A landmark that
// no sighting of weight above 0 reaches is held too.
#ifndef OVERTONE_CORE_ESTIMATION_POSE_GRAPH_PROBLEM_H_
#define OVERTONE_CORE_ESTIMATION_POSE_GRAPH_PROBLEM_H_

#include <atomic>
#include <limits>
#include <memory>
#include <utility>
#include <vector>

#include "ceres/problem.h"
#include "overtone/core/estimation/pose_graph_check.h"
#include "overtone/core/estimation/relative_pose_error.h"
#include "overtone/core/estimation/robust_loss.h"
#include "overtone/core/graph/pose_graph.h"

namespace overtone {

struct SolveLimits {
  int max_iterations = 0;
  int max_steps = std::numeric_limits<int>::max();  // iterations that lower the cost
  double function_tolerance = 0;                    // relative decrease of the cost
  int num_threads = 1;
  const std::atomic<bool>* give_up = nullptr;  // true ends the solve; null: nothing does
};

struct SolveSummary {
  double initial_cost = 0;
  double final_cost = 0;
  int iterations = 0;
  bool converged = false;
  bool given_up = false;
};

// The loss of what may be wrong, with the limit c^2 of each kind (robust_loss.h).
struct PoseGraphLoss {
  RobustLoss loss = RobustLoss::kNone;
  double closure_squared_limit = 0;
  double sighting_squared_limit = 0;
};

struct PoseGraphEstimate {
  std::vector<Rigid3d> poses;
  std::vector<Eigen::Vector3d> landmarks;
};

// Measurements are counted through: the edges first, then the sightings. Not thread-safe. `graph`
// must outlive it.
class PoseGraphProblem {
 public:
  // graph: has passed CheckAndFactorise, where `factors` come from. Graduated losses start at
  // weight 1.
  PoseGraphProblem(const PoseGraph& graph, const PoseGraphFactors& factors,
                   const PoseGraphLoss& loss);
  PoseGraphProblem(const PoseGraphProblem&) = delete;
  PoseGraphProblem& operator=(const PoseGraphProblem&) = delete;

  // Keeps these variables (poses first) as they are; empty: none.
  void Hold(std::vector<bool> variables) { to_stay_ = std::move(variables); }

  // Minimises from the present estimate. Never fails outright: a solver that cannot go on leaves
  // the best estimate so far.
  SolveSummary Solve(const SolveLimits& limits);

  // Loop closures and sightings.
  bool MayBeWrong(int measurement) const { return measurements_[measurement].scale != nullptr; }
  // Scales the cost of a measurement that may be wrong. [0, 1]
  void SetWeight(int measurement, double weight);
  // |r|^2 at the present estimate, unweighted.
  double ChiSquare(int measurement) const;
  // The same in units of the limit of its kind: above 1 it is an outlier.
  double ChiSquareOverLimit(int measurement) const;
  // At the present estimate: that of SetWeight or the derivative of its loss.
  double Weight(int measurement) const;

  int NumMeasurements() const { return static_cast<int>(measurements_.size()); }
  // Over all measurements, whatever their weight; a landmark nobody sees is none.
  int NumComponents() const;

  void SetEstimate(const PoseGraphEstimate& estimate);
  // Moves every landmark into the middle (the median of each coordinate) of where its sightings of
  // weight above 0 see it from the present poses; without any it stays.
  void PlaceLandmarks();
  PoseGraphEstimate Estimate() const;

 private:
  struct Measurement {
    std::unique_ptr<ceres::CostFunction> error;
    std::unique_ptr<ceres::LossFunctionWrapper> scale;  // null: trusted
    const ceres::LossFunction* loss = nullptr;
    double squared_limit = 0;
    double weight = 1;
    int ends[2] = {0, 0};  // variables: pose i is i, landmark i is num_poses_ + i
  };

  void Add(Measurement measurement, bool may_be_wrong);
  double* Block(int variable);
  const double* Block(int variable) const;
  void HoldOnePosePerComponent();

  const PoseGraph& graph_;
  const int num_poses_;
  const int num_landmarks_;
  const std::unique_ptr<ceres::LossFunction> closure_loss_;  // null for kNone and graduated losses
  const std::unique_ptr<ceres::LossFunction> sighting_loss_;
  PoseManifold manifold_;
  std::vector<double> blocks_;  // kPoseBlockSize for each pose, then kPointBlockSize
  std::vector<Measurement> measurements_;
  std::vector<bool> to_stay_;                // one for each variable, or empty
  std::vector<bool> held_;                   // one for each variable: in the last solve
  std::unique_ptr<ceres::Problem> problem_;  // last: refers to the others
};

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_POSE_GRAPH_PROBLEM_H_
