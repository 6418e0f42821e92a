// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/spanning_tree_initialisation.h"

#include <deque>

namespace overtone {

std::vector<Rigid3d> SpanningTreeInitialisation(const PoseGraph& graph) {
  const int num_poses = static_cast<int>(graph.poses.size());
  std::vector<std::vector<int>> edges_of(num_poses);
  for (int k = 0; k < static_cast<int>(graph.edges.size()); ++k) {
    edges_of[graph.edges[k].from].push_back(k);
    edges_of[graph.edges[k].to].push_back(k);
  }
  struct Arrival {
    int pose;
    Rigid3d world_from_body;
  };
  std::vector<Rigid3d> poses = graph.poses;
  std::vector<bool> reached(num_poses, false);
  for (int root = 0; root < num_poses; ++root) {
    // Breadth first with closures of length 1 and odometry of length 0: odometry goes to the front.
    std::deque<Arrival> queue = {{root, poses[root]}};
    while (!queue.empty()) {
      const Arrival arrival = queue.front();
      queue.pop_front();
      if (reached[arrival.pose]) continue;
      reached[arrival.pose] = true;
      poses[arrival.pose] = arrival.world_from_body;
      for (const int k : edges_of[arrival.pose]) {
        const PoseGraphEdge& edge = graph.edges[k];
        const bool forward = edge.from == arrival.pose;
        const int other = forward ? edge.to : edge.from;
        if (reached[other]) continue;
        const Arrival next{other,
                           arrival.world_from_body *
                               (forward ? edge.from_tform_to : edge.from_tform_to.Inverse())};
        edge.kind == EdgeKind::kOdometry ? queue.push_front(next) : queue.push_back(next);
      }
    }
  }
  return poses;
}

}  // namespace overtone
