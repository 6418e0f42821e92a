// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/local_optimisation.h"

#include "gtest/gtest.h"
#include "overtone/tests/core/estimation/pose_graph_test_support.h"

namespace overtone {
namespace {

constexpr int kPoses = 1000;

PoseGraphOptimizerOptions Gnc() {
  PoseGraphOptimizerOptions options;
  options.loss = RobustLoss::kTruncatedLeastSquares;
  options.function_tolerance = 1e-12;
  return options;
}

// Closures over ten poses all along, optimised.
PoseGraph Settled(std::mt19937& random) {
  PoseGraph graph = RandomWalk(kPoses, 0.02, random);
  graph.poses = OptimizePoseGraph(graph, Gnc())->poses;
  return graph;
}

PoseGraphEdge ClosureOf(const PoseGraph& graph, int from, int to, const Vector6d& error) {
  PoseGraphEdge edge;
  edge.from = from;
  edge.to = to;
  edge.from_tform_to = graph.poses[from].Inverse() * graph.poses[to] * Exp(error);
  edge.information = Matrix6d::Identity() / 4e-4;
  edge.kind = EdgeKind::kLoopClosure;
  return edge;
}

TEST(OptimizeLocally, LeavesAGraphAtRestAlone) {
  std::mt19937 random(1);
  const PoseGraph graph = Settled(random);
  const auto result = OptimizeLocally(graph, Gnc());
  ASSERT_TRUE(result.ok() && result->has_value());
  EXPECT_EQ((*result)->iterations, 0);
  EXPECT_EQ(WorstDistance((*result)->poses, graph.poses), 0);
  EXPECT_EQ((*result)->number_of_components, 1);
}

// Where a map grows: little hangs on what is behind the closure. The cost is that of a solve of the
// whole to a millionth, and far away nothing has moved at all.
TEST(OptimizeLocally, ANewClosureMovesItsNeighbourhoodAndCostsAsTheWhole) {
  std::mt19937 random(2);
  const PoseGraph settled = Settled(random);
  for (int trial = 0; trial < 10; ++trial) {
    PoseGraph graph = settled;
    const int from = kPoses - 8 - static_cast<int>(random() % 10);
    graph.edges.push_back(ClosureOf(graph, from, from + 7, RandomVector(random, 0.02)));
    const auto local = OptimizeLocally(graph, Gnc());
    ASSERT_TRUE(local.ok() && local->has_value()) << trial;
    const auto whole = OptimizePoseGraph(graph, Gnc());
    ASSERT_TRUE(whole.ok());
    EXPECT_GT((*local)->iterations, 0);
    EXPECT_NEAR((*local)->initial_cost, whole->initial_cost, 1e-9 * whole->initial_cost);
    EXPECT_NEAR((*local)->final_cost, whole->final_cost, 1e-6 * whole->final_cost) << trial;
    EXPECT_EQ((*local)->weights, whole->weights);
    int still = 0;
    for (int i = 0; i < kPoses; ++i) {
      still += Distance((*local)->poses[i], graph.poses[i]) == 0;
    }
    EXPECT_GT(still, kPoses / 2) << trial;
  }
}

TEST(OptimizeLocally, GivesTheWholeBackWhenAClosureContradictsIt) {
  std::mt19937 random(3);
  PoseGraph graph = Settled(random);
  graph.edges.push_back(ClosureOf(graph, 500, 507, Vector6d::Constant(1)));
  const auto result = OptimizeLocally(graph, Gnc());
  ASSERT_TRUE(result.ok());
  EXPECT_FALSE(result->has_value());
}

// A closure in the middle of a chain turns all that comes after: held at a border near by, that
// would pass for rest by what each pose gains alone.
TEST(OptimizeLocally, InTheMiddleOfAChainItCostsAsTheWholeOrGivesItBack) {
  std::mt19937 random(7);
  const PoseGraph settled = Settled(random);
  for (int trial = 0; trial < 10; ++trial) {
    PoseGraph graph = settled;
    const int from = 300 + 40 * trial;
    graph.edges.push_back(ClosureOf(graph, from, from + 7, RandomVector(random, 0.02)));
    const auto local = OptimizeLocally(graph, Gnc());
    ASSERT_TRUE(local.ok());
    if (!local->has_value()) continue;
    const auto whole = OptimizePoseGraph(graph, Gnc());
    EXPECT_NEAR((*local)->final_cost, whole->final_cost, 1e-6 * whole->final_cost) << trial;
  }
}

TEST(OptimizeLocally, GivesTheWholeBackWhenAllOfItHasToBend) {
  std::mt19937 random(4);
  PoseGraph graph = Settled(random);
  PoseGraphEdge ends = ClosureOf(graph, kPoses - 1, 0, Vector6d::Constant(0.1));
  graph.edges.push_back(ends);
  const auto result = OptimizeLocally(graph, Gnc());
  ASSERT_TRUE(result.ok());
  EXPECT_FALSE(result->has_value());
}

TEST(OptimizeLocally, ALandmarkSeenOnceMoreMovesWithThosePosesThatSeeIt) {
  std::mt19937 random(5);
  PoseGraph graph = RandomWalk(kPoses, 0.02, random);
  graph.landmarks.push_back(graph.poses[kPoses - 10] * Eigen::Vector3d(2, 1, 0));
  const auto see = [&](int pose, const Eigen::Vector3d& error) {
    PointSighting sighting;
    sighting.pose = pose;
    sighting.landmark = 0;
    sighting.point_in_pose = graph.poses[pose].Inverse() * graph.landmarks[0] + error;
    sighting.information = Eigen::Matrix3d::Identity() / 4e-4;
    graph.sightings.push_back(sighting);
  };
  see(kPoses - 12, {0.02, 0, 0});
  see(kPoses - 9, {0, -0.02, 0});
  const auto settled = OptimizePoseGraph(graph, Gnc());
  graph.poses = settled->poses;
  graph.landmarks = settled->landmarks;
  see(kPoses - 5, {0, 0.03, 0.02});
  const auto local = OptimizeLocally(graph, Gnc());
  ASSERT_TRUE(local.ok() && local->has_value());
  const auto whole = OptimizePoseGraph(graph, Gnc());
  EXPECT_NEAR((*local)->final_cost, whole->final_cost, 1e-6 * whole->final_cost);
  EXPECT_LT(((*local)->landmarks[0] - whole->landmarks[0]).norm(), 1e-3);
  EXPECT_NE((*local)->landmarks[0], graph.landmarks[0]);
}

TEST(OptimizeLocally, CanBeGivenUp) {
  std::mt19937 random(6);
  PoseGraph graph = Settled(random);
  graph.edges.push_back(ClosureOf(graph, 500, 507, Vector6d::Constant(0.01)));
  const std::atomic<bool> give_up{true};
  PoseGraphOptimizerOptions options = Gnc();
  options.give_up = &give_up;
  EXPECT_TRUE(absl::IsCancelled(OptimizeLocally(graph, options).status()));
  EXPECT_TRUE(absl::IsCancelled(OptimizePoseGraph(graph, options).status()));
}

}  // namespace
}  // namespace overtone
