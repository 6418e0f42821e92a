// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/active_set.h"

#include <algorithm>
#include <unordered_map>

namespace overtone {

ActiveSet::ActiveSet(const PoseGraph& graph)
    : graph_(graph),
      num_variables_(static_cast<int>(graph.poses.size() + graph.landmarks.size())),
      num_measurements_(static_cast<int>(graph.edges.size() + graph.sightings.size())),
      first_of_(num_variables_ + 1, 0),
      measurements_of_(2 * num_measurements_),
      is_active_(num_variables_, false) {
  for (int k = 0; k < num_measurements_; ++k) {
    const auto [a, b] = EndsOf(k);
    ++first_of_[a + 1];
    ++first_of_[b + 1];
  }
  for (int i = 0; i < num_variables_; ++i) first_of_[i + 1] += first_of_[i];
  std::vector<int> next(first_of_.begin(), first_of_.end() - 1);
  for (int k = 0; k < num_measurements_; ++k) {
    const auto [a, b] = EndsOf(k);
    measurements_of_[next[a]++] = k;
    measurements_of_[next[b]++] = k;
  }
}

std::pair<int, int> ActiveSet::EndsOf(int measurement) const {
  const int num_edges = static_cast<int>(graph_.edges.size());
  if (measurement < num_edges) {
    return {graph_.edges[measurement].from, graph_.edges[measurement].to};
  }
  const PointSighting& sighting = graph_.sightings[measurement - num_edges];
  return {sighting.pose, sighting.landmark >= 0
                             ? static_cast<int>(graph_.poses.size()) + sighting.landmark
                             : sighting.target_pose};
}

void ActiveSet::Grow(const std::vector<int>& seeds, int reach) {
  std::vector<int> front = seeds;
  std::unordered_map<int, bool> seen;  // an active variable passes the wave on, too
  for (const int seed : seeds) seen[seed] = true;
  for (int step = 0;; ++step) {
    for (const int variable : front) {
      if (is_active_[variable]) continue;
      is_active_[variable] = true;
      active_.push_back(variable);
    }
    if (step == reach) break;
    std::vector<int> next;
    for (const int variable : front) {
      for (int m = first_of_[variable]; m < first_of_[variable + 1]; ++m) {
        const auto [a, b] = EndsOf(measurements_of_[m]);
        const int other = a == variable ? b : a;
        if (seen.insert({other, true}).second) next.push_back(other);
      }
    }
    front = std::move(next);
  }
  num_active_ = static_cast<int>(active_.size());
  FindBorder();
}

void ActiveSet::FindBorder() {
  border_.clear();
  measurements_.clear();
  for (const int variable : active_) {
    for (int m = first_of_[variable]; m < first_of_[variable + 1]; ++m) {
      const int measurement = measurements_of_[m];
      const auto [a, b] = EndsOf(measurement);
      const int other = a == variable ? b : a;
      if (!is_active_[other]) border_.push_back(other);
      if (!is_active_[other] || variable < other) measurements_.push_back(measurement);
    }
  }
  std::sort(border_.begin(), border_.end());
  border_.erase(std::unique(border_.begin(), border_.end()), border_.end());
  std::sort(measurements_.begin(), measurements_.end());
}

ActiveSet::Part ActiveSet::Extract(const std::vector<Rigid3d>& poses,
                                   const std::vector<Eigen::Vector3d>& landmarks) const {
  const int num_poses = static_cast<int>(graph_.poses.size());
  Part part;
  part.variables = active_;
  part.variables.insert(part.variables.end(), border_.begin(), border_.end());
  std::sort(part.variables.begin(), part.variables.end());
  std::unordered_map<int, int> number_of;  // a pose's or a landmark's among its kind
  for (const int variable : part.variables) {
    part.held.push_back(!is_active_[variable]);
    if (variable < num_poses) {
      number_of[variable] = static_cast<int>(part.graph.poses.size());
      part.graph.poses.push_back(poses[variable]);
    } else {
      number_of[variable] = static_cast<int>(part.graph.landmarks.size());
      part.graph.landmarks.push_back(landmarks[variable - num_poses]);
    }
  }
  part.measurements = measurements_;
  for (const int measurement : measurements_) {
    const auto [a, b] = EndsOf(measurement);
    if (measurement < static_cast<int>(graph_.edges.size())) {
      PoseGraphEdge& edge = part.graph.edges.emplace_back(graph_.edges[measurement]);
      edge.from = number_of[a];
      edge.to = number_of[b];
      continue;
    }
    PointSighting& sighting =
        part.graph.sightings.emplace_back(graph_.sightings[measurement - graph_.edges.size()]);
    sighting.pose = number_of[a];
    (sighting.landmark >= 0 ? sighting.landmark : sighting.target_pose) = number_of[b];
  }
  return part;
}

}  // namespace overtone
