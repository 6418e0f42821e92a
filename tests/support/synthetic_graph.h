// SPDX-License-Identifier: Apache-2.0
// Graphs for tests and benchmarks: closed forms, random ones, and the radius graph of a simulated
// team.
#ifndef OVERTONE_TESTS_SUPPORT_SYNTHETIC_GRAPH_H_
#define OVERTONE_TESTS_SUPPORT_SYNTHETIC_GRAPH_H_

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "Eigen/Core"
#include "overtone/core/spectral/edge_weights.h"
#include "overtone/core/spectral/graph_laplacian.h"

namespace overtone {

struct WeightedEdge {
  int first;
  int second;
  double weight;
};

inline SparseMatrix LaplacianOfEdges(int num_nodes, const std::vector<WeightedEdge>& edges) {
  std::vector<Eigen::Triplet<double>> entries;
  for (const WeightedEdge& edge : edges) {
    entries.emplace_back(edge.first, edge.second, edge.weight);
    entries.emplace_back(edge.second, edge.first, edge.weight);
  }
  SparseMatrix adjacency(num_nodes, num_nodes);
  adjacency.setFromTriplets(entries.begin(), entries.end());
  return GraphLaplacian(adjacency);
}

inline SparseMatrix PathGraphLaplacian(int num_nodes, double weight = 1) {
  std::vector<WeightedEdge> edges;
  for (int i = 0; i + 1 < num_nodes; ++i) edges.push_back({i, i + 1, weight});
  return LaplacianOfEdges(num_nodes, edges);
}

// Node 0 is the hub.
inline SparseMatrix StarGraphLaplacian(int num_nodes) {
  std::vector<WeightedEdge> edges;
  for (int i = 1; i < num_nodes; ++i) edges.push_back({0, i, 1});
  return LaplacianOfEdges(num_nodes, edges);
}

inline SparseMatrix CompleteGraphLaplacian(int num_nodes) {
  std::vector<WeightedEdge> edges;
  for (int i = 0; i < num_nodes; ++i) {
    for (int j = i + 1; j < num_nodes; ++j) edges.push_back({i, j, 1});
  }
  return LaplacianOfEdges(num_nodes, edges);
}

// A path through all nodes, so connected, and `num_chords` random edges; weights in [0.1, 1].
inline SparseMatrix RandomConnectedLaplacian(int num_nodes, int num_chords, uint32_t seed) {
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> weight(0.1, 1);
  std::uniform_int_distribution<int> node(0, num_nodes - 1);
  std::vector<WeightedEdge> edges;
  for (int i = 0; i + 1 < num_nodes; ++i) edges.push_back({i, i + 1, weight(generator)});
  for (int k = 0; k < num_chords; ++k) {
    const int i = node(generator), j = node(generator);
    if (i != j) edges.push_back({i, j, weight(generator)});
  }
  return LaplacianOfEdges(num_nodes, edges);
}

// Five robots with keyframes every 0.4 m walk about one square, sized so that a 7 m ball holds
// about 120 others on average whatever the number of nodes.
struct SyntheticTeam {
  std::vector<Rigid3d> server;   // robot after robot
  std::vector<Rigid3d> onboard;  // with accumulated drift

  SparseMatrix Laplacian() const {
    return GraphLaplacian(*RadiusGraphAdjacency(server, RadiusGraphOptions()));
  }
  // Difference of the server's and the robots' distances from the first node.
  Eigen::VectorXd DifferenceSignal() const {
    Eigen::VectorXd difference(server.size());
    for (size_t i = 0; i < server.size(); ++i) {
      difference[i] = PoseDistance(server[0], server[i], DistanceMetric::kSe3, {}) -
                      PoseDistance(onboard[0], onboard[i], DistanceMetric::kSe3, {});
    }
    return difference;
  }
  // The six channels of the difference of the logarithms.
  Eigen::MatrixXd LogDifferenceSignal() const {
    Eigen::MatrixXd difference(server.size(), 6);
    for (size_t i = 0; i < server.size(); ++i) {
      difference.row(i) =
          Log(server[0].Inverse() * server[i]) - Log(onboard[0].Inverse() * onboard[i]);
    }
    return difference;
  }
};

inline SyntheticTeam MakeSyntheticTeam(int num_nodes, uint32_t seed = 1) {
  constexpr int kNumRobots = 5;
  constexpr double kStep = 0.4, kNodesInBall = 120;
  const double side = std::sqrt(num_nodes * M_PI * 49 / kNodesInBall);
  std::mt19937 generator(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal;
  SyntheticTeam team;
  for (int robot = 0; robot < kNumRobots; ++robot) {
    Eigen::Vector3d position(side * uniform(generator), side * uniform(generator), 0);
    double heading = 2 * M_PI * uniform(generator);
    Rigid3d drift;
    const int end = num_nodes * (robot + 1) / kNumRobots;
    while (static_cast<int>(team.server.size()) < end) {
      heading += 0.15 * normal(generator);
      Eigen::Vector3d next =
          position + kStep * Eigen::Vector3d(std::cos(heading), std::sin(heading), 0);
      if (next.head<2>().minCoeff() < 0 || next.head<2>().maxCoeff() > side) {
        heading += 0.5;  // turn away from the wall
        continue;
      }
      next.z() = std::sin(0.1 * next.x());
      position = next;
      const Eigen::Vector3d attitude(0.05 * normal(generator), 0.05 * normal(generator), 0);
      const Rigid3d pose(ExpSO3(Eigen::Vector3d(0, 0, heading)) * ExpSO3(attitude), position);
      Vector6d noise;
      for (double& entry : noise) entry = normal(generator);
      noise.head<3>() *= 0.01;
      noise.tail<3>() *= 0.001;
      drift = drift * Exp(noise);
      team.server.push_back(pose);
      team.onboard.push_back(drift * pose);
    }
  }
  return team;
}

}  // namespace overtone

#endif  // OVERTONE_TESTS_SUPPORT_SYNTHETIC_GRAPH_H_
