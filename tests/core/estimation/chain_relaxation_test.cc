// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/chain_relaxation.h"

#include "Eigen/LU"
#include "gtest/gtest.h"
#include "overtone/core/estimation/pose_graph_optimizer.h"
#include "overtone/core/estimation/uncertain_trajectory.h"
#include "overtone/tests/core/estimation/pose_graph_test_support.h"

namespace overtone {
namespace {

struct Chain {
  ChainMotions motions;
  std::vector<Rigid3d> poses;
};

// As by odometry, about a metre from pose to pose, bends of some 20 degrees.
Chain RandomChain(int num_poses, std::mt19937& random) {
  Chain chain;
  Rigid3d pose = RandomPose(random);
  for (int k = 0; k < num_poses; ++k) {
    Vector6d step = RandomVector(random, 0.2);
    step(0) += 1;
    const Rigid3d motion = k == 0 ? Rigid3d() : Exp(step);
    pose = pose * motion;
    chain.poses.push_back(pose);
    chain.motions.push_back({motion, PackedCovariance(1e-4 * RandomInformation(random))});
  }
  return chain;
}

PoseGraph GraphOf(const Chain& chain) {
  PoseGraph graph;
  graph.poses = chain.poses;
  for (int k = 1; k < static_cast<int>(chain.poses.size()); ++k) {
    graph.edges.push_back({k - 1, k, chain.motions[k].previous_from_this,
                           chain.motions[k].covariance.Unpacked().inverse(), EdgeKind::kOdometry});
  }
  return graph;
}

double EdgeChiSquare(const CompoundMotion& edge, const Rigid3d& first_from_last) {
  const Vector6d error = Log(edge.first_from_last.Inverse() * first_from_last);
  return error.dot(edge.information * error);
}

TEST(ChainRelaxation, UndisturbedOdometryIsItsOwnBestPath) {
  std::mt19937 random(1);
  Chain chain = RandomChain(20, random);
  UncertainTrajectory path;
  for (int k = 0; k < 20; ++k) {
    path.Append(chain.poses[k], chain.motions[k].covariance.Unpacked());
  }
  const std::vector<Rigid3d> before = chain.poses;
  const CompoundMotion edge = RelaxChain(chain.motions, 3, 17, chain.poses);
  EXPECT_LT(WorstDistance(chain.poses, before), 1e-12);
  EXPECT_LT(edge.chi_square, 1e-15);
  EXPECT_LT(Distance(edge.first_from_last, path.Relative(3, 17)), 1e-9);
  const Matrix6d covariance = path.Covariance(3, 17);
  EXPECT_LT((edge.information.inverse() - covariance).norm(), 1e-6 * covariance.norm());
}

// The optimiser with both ends held finds the same path and the same cost; outside nothing moves.
TEST(ChainRelaxation, ABentStretchIsWhatTheOptimiserMakesOfIt) {
  std::mt19937 random(2);
  for (const double bend : {0.01, 0.1, 0.4}) {
    Chain chain = RandomChain(25, random);
    chain.poses.back() = chain.poses.back() * Exp(RandomVector(random, bend));
    const PoseGraph graph = GraphOf(chain);
    PoseGraphOptimizerOptions options;
    options.function_tolerance = 1e-14;
    options.held.assign(25, false);
    options.held.front() = options.held.back() = true;
    const auto best = OptimizePoseGraph(graph, options);
    ASSERT_TRUE(best.ok()) << best.status();
    const CompoundMotion edge = RelaxChain(chain.motions, 0, 24, chain.poses);
    EXPECT_EQ(Distance(chain.poses.back(), graph.poses.back()), 0) << bend;
    EXPECT_LT(WorstDistance(chain.poses, best->poses), 1e-4) << bend;
    EXPECT_NEAR(edge.chi_square, 2 * best->final_cost, 1e-7 * (1 + best->final_cost)) << bend;
    EXPECT_NEAR(EdgeChiSquare(edge, chain.poses.front().Inverse() * chain.poses.back()),
                edge.chi_square, 1e-6 * edge.chi_square)
        << bend;
  }
}

// Central differences of the relaxed chain's cost by its last pose, against those of its edge.
TEST(ChainRelaxation, TheEdgeHasTheStretchsGradient) {
  std::mt19937 random(3);
  Chain chain = RandomChain(15, random);
  chain.poses.back() = chain.poses.back() * Exp(RandomVector(random, 0.2));
  const CompoundMotion edge = RelaxChain(chain.motions, 0, 14, chain.poses);
  const double h = 1e-4;
  for (int axis = 0; axis < 6; ++axis) {
    double of_chain = 0, of_edge = 0;
    for (const double sign : {-1, 1}) {
      Chain moved = chain;
      moved.poses.back() = moved.poses.back() * Exp(sign * h * Vector6d::Unit(axis));
      of_chain += sign * RelaxChain(moved.motions, 0, 14, moved.poses).chi_square / (2 * h);
      of_edge +=
          sign * EdgeChiSquare(edge, moved.poses.front().Inverse() * moved.poses.back()) / (2 * h);
    }
    EXPECT_NEAR(of_chain, of_edge, 1e-3 * (1 + std::abs(of_edge))) << axis;
  }
}

// Ends that no odometry can have brought there: the poses stay finite, and nothing gets worse.
TEST(ChainRelaxation, TornEndsLeaveAPathThatCostsNoMoreThanBefore) {
  std::mt19937 random(4);
  Chain chain = RandomChain(10, random);
  chain.poses.back() = chain.poses.back() * Rigid3d(ExpSO3({0, 0, 3}), {300, -200, 50});
  PoseGraphOptimizerOptions nothing;
  nothing.max_iterations = 0;
  const double before = OptimizePoseGraph(GraphOf(chain), nothing)->final_cost;
  const CompoundMotion edge = RelaxChain(chain.motions, 0, 9, chain.poses);
  for (const Rigid3d& pose : chain.poses) EXPECT_TRUE(pose.translation.allFinite());
  EXPECT_LE(edge.chi_square, 2 * before * (1 + 1e-9));
  EXPECT_TRUE(edge.information.allFinite());
}

}  // namespace
}  // namespace overtone
