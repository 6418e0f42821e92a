// SPDX-License-Identifier: Apache-2.0
// Random poses, matrices and small pose graphs with known truth.
#ifndef OVERTONE_TESTS_CORE_ESTIMATION_POSE_GRAPH_TEST_SUPPORT_H_
#define OVERTONE_TESTS_CORE_ESTIMATION_POSE_GRAPH_TEST_SUPPORT_H_

#include <algorithm>
#include <random>
#include <vector>

#include "overtone/core/graph/pose_graph.h"

namespace overtone {

inline Vector6d RandomVector(std::mt19937& random, double scale) {
  std::normal_distribution<double> normal(0, scale);
  Vector6d vector;
  for (int i = 0; i < 6; ++i) vector(i) = normal(random);
  return vector;
}

inline Rigid3d RandomPose(std::mt19937& random) { return Exp(RandomVector(random, 1)); }

// Full, positive definite, eigenvalues from about 1 to 100.
inline Matrix6d RandomInformation(std::mt19937& random) {
  Matrix6d factor;
  for (int i = 0; i < 6; ++i) factor.col(i) = RandomVector(random, 3);
  return factor * factor.transpose() + Matrix6d::Identity();
}

inline double Distance(const Rigid3d& a, const Rigid3d& b) { return Log(a.Inverse() * b).norm(); }

inline double WorstDistance(const std::vector<Rigid3d>& a, const std::vector<Rigid3d>& b) {
  double worst = 0;
  for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, Distance(a[i], b[i]));
  return worst;
}

// A random walk with odometry and a closure from every fifth pose back to the one ten before, all
// disturbed by noise of `sigma` and weighted accordingly. poses: the truth.
inline PoseGraph RandomWalk(int num_poses, double sigma, std::mt19937& random) {
  PoseGraph graph;
  graph.poses.push_back(RandomPose(random));
  const Matrix6d information = Matrix6d::Identity() / (sigma > 0 ? sigma * sigma : 1e-4);
  const auto add_edge = [&](int from, int to, EdgeKind kind) {
    const Rigid3d truth = graph.poses[from].Inverse() * graph.poses[to];
    graph.edges.push_back({from, to, truth * Exp(RandomVector(random, sigma)), information, kind});
  };
  for (int i = 1; i < num_poses; ++i) {
    Vector6d step = RandomVector(random, 0.3);
    step(0) += 1;
    graph.poses.push_back(graph.poses.back() * Exp(step));
    add_edge(i - 1, i, EdgeKind::kOdometry);
    if (i >= 10 && i % 5 == 0) add_edge(i, i - 10, EdgeKind::kLoopClosure);
  }
  return graph;
}

}  // namespace overtone

#endif  // OVERTONE_TESTS_CORE_ESTIMATION_POSE_GRAPH_TEST_SUPPORT_H_
