// SPDX-License-Identifier: Apache-2.0
// How far each pose and landmark of a graph is from rest: the gradient of the cost
//
//     1/2 sum w_k |r_k|^2_Omega_k
//
// by the variable's own tangent, and what moving it alone would gain, 1/2 g^T H^-1 g with its own
// block H of the Gauss-Newton Hessian. Variables: pose i is i, landmark i is poses.size() + i.
#ifndef OVERTONE_CORE_ESTIMATION_POSE_GRAPH_UNREST_H_
#define OVERTONE_CORE_ESTIMATION_POSE_GRAPH_UNREST_H_

#include <vector>

#include "overtone/core/graph/pose_graph.h"

namespace overtone {

// Measurements are counted through: the edges first, then the sightings.
class PoseGraphUnrest {
 public:
  // graph: has passed CheckPoseGraph; must outlive it. weights: one for each measurement.
  PoseGraphUnrest(const PoseGraph& graph, std::vector<double> weights);

  // Takes a measurement into account at the given estimate, in place of where it was before.
  // Without that at first, it counts for nothing.
  void Update(int measurement, const std::vector<Rigid3d>& poses,
              const std::vector<Eigen::Vector3d>& landmarks);

  // What moving this variable alone would gain.
  double GainAlone(int variable) const;

  const std::vector<double>& chi_squares() const { return chi_squares_; }
  const std::vector<double>& weights() const { return weights_; }
  // At the estimates of the last updates.
  double Cost() const;

 private:
  // By the two ends of a measurement, unused rows zero.
  struct Pull {
    Vector6d gradient[2] = {Vector6d::Zero(), Vector6d::Zero()};
    Matrix6d hessian[2] = {Matrix6d::Zero(), Matrix6d::Zero()};
    double chi_square = 0;
  };

  Pull PullOf(const PoseGraphEdge& edge, const std::vector<Rigid3d>& poses) const;
  Pull PullOf(const PointSighting& sighting, const std::vector<Rigid3d>& poses,
              const std::vector<Eigen::Vector3d>& landmarks) const;

  const PoseGraph& graph_;
  std::vector<double> weights_;
  std::vector<double> chi_squares_;
  struct Counted {
    Vector6d of_ends[2] = {Vector6d::Zero(),
                           Vector6d::Zero()};  // what its ends' gradients hold of it
    bool is_counted = false;
  };
  std::vector<Counted> counted_;  // of each measurement
  std::vector<Vector6d> gradients_;
  std::vector<Matrix6d> hessians_;  // as first counted: a scale
};

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_POSE_GRAPH_UNREST_H_
