// SPDX-License-Identifier: Apache-2.0
// Both first guesses of a pose graph: by spanning tree and by chordal relaxation.
#include "gtest/gtest.h"
#include "overtone/core/estimation/chordal_initialisation.h"
#include "overtone/core/estimation/spanning_tree_initialisation.h"
#include "overtone/tests/core/estimation/pose_graph_test_support.h"

namespace overtone {
namespace {

// All poses but the first forgotten.
PoseGraph Forget(PoseGraph graph) {
  for (size_t i = 1; i < graph.poses.size(); ++i) graph.poses[i] = Rigid3d();
  return graph;
}

TEST(SpanningTreeInitialisation, RecoversTheTruthFromExactMeasurements) {
  std::mt19937 random(1);
  const PoseGraph graph = RandomWalk(40, /*sigma=*/0, random);
  EXPECT_LT(WorstDistance(SpanningTreeInitialisation(Forget(graph)), graph.poses), 1e-9);
}

TEST(SpanningTreeInitialisation, FollowsOdometryAndNotClosuresWhereBothLead) {
  PoseGraph graph;
  graph.poses.resize(3);
  const Rigid3d step(Eigen::Quaterniond::Identity(), {1, 0, 0});
  const Rigid3d wrong(Eigen::Quaterniond::Identity(), {50, 0, 0});
  graph.edges.push_back({0, 2, wrong, Matrix6d::Identity(), EdgeKind::kLoopClosure});
  graph.edges.push_back({0, 1, step, Matrix6d::Identity(), EdgeKind::kOdometry});
  graph.edges.push_back({1, 2, step, Matrix6d::Identity(), EdgeKind::kOdometry});
  EXPECT_NEAR(SpanningTreeInitialisation(graph)[2].translation.x(), 2, 1e-12);
}

TEST(SpanningTreeInitialisation, CrossesAClosureBackwardsToReachAnotherMission) {
  PoseGraph graph;
  graph.poses.resize(3);
  const Rigid3d step(Eigen::Quaterniond::Identity(), {1, 0, 0});
  graph.edges.push_back({1, 2, step, Matrix6d::Identity(), EdgeKind::kOdometry});
  graph.edges.push_back({2, 0, step, Matrix6d::Identity(), EdgeKind::kLoopClosure});
  const auto poses = SpanningTreeInitialisation(graph);
  EXPECT_NEAR(poses[2].translation.x(), -1, 1e-12);
  EXPECT_NEAR(poses[1].translation.x(), -2, 1e-12);
}

TEST(ChordalInitialisation, RecoversTheTruthFromExactMeasurements) {
  std::mt19937 random(2);
  const PoseGraph graph = RandomWalk(40, /*sigma=*/0, random);
  const auto poses = ChordalInitialisation(Forget(graph));
  ASSERT_TRUE(poses.ok()) << poses.status();
  EXPECT_LT(WorstDistance(*poses, graph.poses), 1e-7);
}

TEST(ChordalInitialisation, KeepsTheFirstPoseOfEveryComponent) {
  std::mt19937 random(3);
  PoseGraph graph = RandomWalk(20, 0, random);
  const PoseGraph other = RandomWalk(20, 0, random);
  graph.poses.insert(graph.poses.end(), other.poses.begin(), other.poses.end());
  for (PoseGraphEdge edge : other.edges) {
    edge.from += 20;
    edge.to += 20;
    graph.edges.push_back(edge);
  }
  PoseGraph forgotten = Forget(graph);
  forgotten.poses[20] = graph.poses[20];
  const auto poses = ChordalInitialisation(forgotten);
  ASSERT_TRUE(poses.ok()) << poses.status();
  EXPECT_LT(WorstDistance(*poses, graph.poses), 1e-7);
}

TEST(ChordalInitialisation, SaysWhenEdgesLeaveAPoseUndetermined) {
  PoseGraph graph;
  graph.poses.resize(2);
  graph.edges.push_back({0, 1, Rigid3d(), Matrix6d::Zero(), EdgeKind::kOdometry});
  EXPECT_EQ(ChordalInitialisation(graph).status().code(), absl::StatusCode::kFailedPrecondition);
}

TEST(ChordalInitialisation, AGraphWithoutEdgesStaysAsItIs) {
  PoseGraph graph;
  graph.poses.resize(3);
  const auto poses = ChordalInitialisation(graph);
  ASSERT_TRUE(poses.ok()) << poses.status();
  EXPECT_EQ(poses->size(), 3);
}

}  // namespace
}  // namespace overtone
