// SPDX-License-Identifier: Apache-2.0
// The part of a pose graph that is solved while the rest stays. Variables: pose i is i, landmark i
// is poses.size() + i; measurements: the edges first, then the sightings.
#ifndef OVERTONE_CORE_ESTIMATION_ACTIVE_SET_H_
#define OVERTONE_CORE_ESTIMATION_ACTIVE_SET_H_

#include <utility>
#include <vector>

#include "overtone/core/graph/pose_graph.h"

namespace overtone {

class ActiveSet {
 public:
  // graph: has passed CheckPoseGraph; must outlive it.
  explicit ActiveSet(const PoseGraph& graph);

  // Takes in the seeds and everything up to `reach` measurements away from them.
  void Grow(const std::vector<int>& seeds, int reach);

  int NumActive() const { return num_active_; }
  // Variables that share a measurement with an active one and are none.
  const std::vector<int>& border() const { return border_; }
  // With at least one active end.
  const std::vector<int>& measurements() const { return measurements_; }
  bool IsActive(int variable) const { return is_active_[variable]; }

  // The active variables and their border as a graph of their own.
  struct Part {
    PoseGraph graph;
    std::vector<bool> held;         // the border: poses, then landmarks
    std::vector<int> variables;     // in the whole graph, likewise
    std::vector<int> measurements;  // in the whole graph: edges, then sightings
  };
  Part Extract(const std::vector<Rigid3d>& poses,
               const std::vector<Eigen::Vector3d>& landmarks) const;

 private:
  std::pair<int, int> EndsOf(int measurement) const;
  void FindBorder();

  const PoseGraph& graph_;
  const int num_variables_;
  const int num_measurements_;
  std::vector<int> first_of_;  // of each variable, in measurements_of_
  std::vector<int> measurements_of_;
  std::vector<bool> is_active_;
  int num_active_ = 0;
  std::vector<int> active_;
  std::vector<int> border_;
  std::vector<int> measurements_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_ACTIVE_SET_H_
