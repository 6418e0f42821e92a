// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/pose_graph_optimizer.h"

#include <cmath>
#include <limits>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/estimation/pose_graph_check.h"
#include "overtone/tests/core/estimation/pose_graph_test_support.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

PoseGraphResult Optimise(const PoseGraph& graph, const PoseGraphOptimizerOptions& options = {}) {
  auto result = OptimizePoseGraph(graph, options);
  EXPECT_TRUE(result.ok()) << result.status();
  return result.ok() ? *result : PoseGraphResult();
}

TEST(PoseGraphOptimizer, DefaultOptionsAreValid) {
  EXPECT_TRUE(PoseGraphOptimizerOptions().Validate().ok());
}

// Two measurements of one step on a line: the mean weighted by information.
TEST(PoseGraphOptimizer, FusesTwoMeasurementsByTheirInformation) {
  PoseGraph graph;
  graph.poses.resize(2);
  const auto step = [](double x) { return Rigid3d(Eigen::Quaterniond::Identity(), {x, 0, 0}); };
  graph.edges.push_back({0, 1, step(1), 3 * Matrix6d::Identity(), EdgeKind::kOdometry});
  graph.edges.push_back({0, 1, step(2), 1 * Matrix6d::Identity(), EdgeKind::kLoopClosure});
  const PoseGraphResult result = Optimise(graph);
  EXPECT_NEAR(result.poses[1].translation.x(), 1.25, 1e-7);
  EXPECT_NEAR(result.final_cost, 0.5 * (3 * 0.25 * 0.25 + 0.75 * 0.75), 1e-7);
  EXPECT_NEAR(result.chi_squares[1], 0.75 * 0.75, 1e-7);
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.number_of_components, 1);
}

TEST(PoseGraphOptimizer, AllInitialisationsReachTheSameMinimum) {
  std::mt19937 random(1);
  const PoseGraph graph = RandomWalk(60, 0.02, random);
  const double cost = Optimise(graph).final_cost;
  EXPECT_GT(cost, 0);
  for (const auto initialisation :
       {PoseGraphInitialisation::kSpanningTree, PoseGraphInitialisation::kChordal}) {
    PoseGraphOptimizerOptions options;
    options.initialisation = initialisation;
    EXPECT_NEAR(Optimise(graph, options).final_cost, cost, 1e-9 * cost);
  }
}

// The minimum is a property of the graph, not of the frame it is written in.
TEST(PoseGraphOptimizer, MovingTheFrameMovesTheResultAndNothingElse) {
  std::mt19937 random(2);
  const PoseGraph graph = RandomWalk(40, 0.02, random);
  const Rigid3d move = RandomPose(random);
  PoseGraph moved = graph;
  for (Rigid3d& pose : moved.poses) pose = move * pose;
  const PoseGraphResult a = Optimise(graph), b = Optimise(moved);
  EXPECT_NEAR(a.final_cost, b.final_cost, 1e-9 * a.final_cost);
  for (size_t i = 0; i < graph.poses.size(); ++i) {
    EXPECT_LT(Distance(move * a.poses[i], b.poses[i]), 1e-6) << i;
  }
}

TEST(PoseGraphOptimizer, HoldsTheFirstPoseOfEveryComponent) {
  std::mt19937 random(3);
  const PoseGraph first = RandomWalk(20, 0.02, random);
  PoseGraph graph = first;
  const PoseGraph other = RandomWalk(20, 0.02, random);
  graph.poses.insert(graph.poses.end(), other.poses.begin(), other.poses.end());
  for (PoseGraphEdge edge : other.edges) {
    edge.from += 20;
    edge.to += 20;
    graph.edges.push_back(edge);
  }
  graph.poses.push_back(RandomPose(random));  // on its own
  const PoseGraphResult result = Optimise(graph);
  EXPECT_EQ(result.number_of_components, 3);
  EXPECT_TRUE(result.converged);
  for (const int i : {0, 20, 40}) EXPECT_LT(Distance(result.poses[i], graph.poses[i]), 1e-12) << i;
  EXPECT_NEAR(result.final_cost, Optimise(first).final_cost + Optimise(other).final_cost,
              1e-6 * result.final_cost);
}

TEST(PoseGraphOptimizer, AnEmptyGraphIsSolved) {
  const PoseGraphResult result = Optimise(PoseGraph());
  EXPECT_TRUE(result.poses.empty());
  EXPECT_EQ(result.number_of_components, 0);
}

class RobustLossTest : public ::testing::TestWithParam<RobustLoss> {};

// A fifth of the closures are nonsense.
TEST_P(RobustLossTest, KeepsWrongClosuresFromSpoilingTheResult) {
  std::mt19937 random(4);
  PoseGraph graph = RandomWalk(100, 0.02, random);
  const std::vector<Rigid3d> clean = Optimise(graph).poses;
  const size_t first_wrong = graph.edges.size();
  for (const int from : {90, 75, 60, 45}) {
    graph.edges.push_back(
        {from, from - 40, RandomPose(random), 2500 * Matrix6d::Identity(), EdgeKind::kLoopClosure});
  }
  PoseGraphOptimizerOptions options;
  const double spoilt = WorstDistance(Optimise(graph, options).poses, clean);
  options.loss = GetParam();
  const PoseGraphResult result = Optimise(graph, options);
  for (size_t k = 0; k < graph.edges.size(); ++k) {
    if (graph.edges[k].kind == EdgeKind::kOdometry) {
      EXPECT_EQ(result.weights[k], 1);
    } else if (k < first_wrong) {
      EXPECT_GT(result.weights[k], 0.3) << k;
    } else {
      EXPECT_LT(result.weights[k], 0.3) << k;
    }
  }
  EXPECT_LT(WorstDistance(result.poses, clean), 0.5 * spoilt);
}

INSTANTIATE_TEST_SUITE_P(Losses, RobustLossTest,
                         ::testing::Values(RobustLoss::kCauchy, RobustLoss::kGemanMcClure,
                                           RobustLoss::kTruncatedLeastSquares));

TEST(PoseGraphOptimizer, TruncationLeavesExactlyTheResultWithoutTheWrongClosures) {
  std::mt19937 random(5);
  PoseGraph graph = RandomWalk(100, 0.02, random);
  const PoseGraphResult clean = Optimise(graph);
  graph.edges.push_back(
      {80, 10, RandomPose(random), 2500 * Matrix6d::Identity(), EdgeKind::kLoopClosure});
  PoseGraphOptimizerOptions options;
  options.loss = RobustLoss::kTruncatedLeastSquares;
  const PoseGraphResult result = Optimise(graph, options);
  EXPECT_EQ(result.weights.back(), 0);
  EXPECT_NEAR(result.final_cost, clean.final_cost, 1e-8 * clean.final_cost);
  EXPECT_LT(WorstDistance(result.poses, clean.poses), 1e-5);
}

TEST(PoseGraphOptimizer, AComponentThatLosesItsOnlyTiesStaysWhereItWas) {
  // Two odometry chains with two ties that exclude each other.
  PoseGraph graph;
  const Rigid3d step(Eigen::Quaterniond::Identity(), {1, 0, 0});
  for (int i = 0; i < 8; ++i) {
    graph.poses.push_back(
        Rigid3d(Eigen::Quaterniond::Identity(), {1.0 * (i % 4), 5.0 * (i / 4), 0}));
    if (i % 4 == 0) continue;
    graph.edges.push_back({i - 1, i, step, 1e4 * Matrix6d::Identity(), EdgeKind::kOdometry});
  }
  for (const double y : {-300.0, 300.0}) {
    graph.edges.push_back({1, 5, Rigid3d(Eigen::Quaterniond::Identity(), {0, y, 0}),
                           1e4 * Matrix6d::Identity(), EdgeKind::kLoopClosure});
  }
  PoseGraphOptimizerOptions options;
  options.loss = RobustLoss::kTruncatedLeastSquares;
  const PoseGraphResult result = Optimise(graph, options);
  EXPECT_TRUE(result.converged);
  EXPECT_LE(result.weights[6] + result.weights[7], 1);
  for (int i : {1, 2, 3, 5, 6, 7}) {
    EXPECT_LT(Distance(result.poses[i - 1].Inverse() * result.poses[i], step), 1e-6) << i;
  }
}

struct BadGraph {
  std::string name;
  std::string message;
  void (*spoil)(PoseGraph&);
};

class BadGraphTest : public ::testing::TestWithParam<BadGraph> {};

TEST_P(BadGraphTest, IsRefusedByName) {
  std::mt19937 random(7);
  PoseGraph graph = RandomWalk(12, 0.02, random);
  graph.landmarks.assign(3, Eigen::Vector3d::Zero());
  graph.sightings.resize(5);
  for (PointSighting& sighting : graph.sightings) sighting.landmark = 2;
  ASSERT_TRUE(CheckPoseGraph(graph).ok()) << CheckPoseGraph(graph);
  GetParam().spoil(graph);
  for (const auto initialisation :
       {PoseGraphInitialisation::kGiven, PoseGraphInitialisation::kSpanningTree,
        PoseGraphInitialisation::kChordal}) {
    PoseGraphOptimizerOptions options;
    options.initialisation = initialisation;
    const auto result = OptimizePoseGraph(graph, options);
    EXPECT_EQ(result.status().code(), absl::StatusCode::kInvalidArgument);
    EXPECT_THAT(std::string(result.status().message()), HasSubstr(GetParam().message));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Fields, BadGraphTest,
    ::testing::Values(
        BadGraph{"FromNegative", "edges[3]: from = -1 is out of range",
                 [](PoseGraph& g) { g.edges[3].from = -1; }},
        BadGraph{"ToTooLarge", "edges[0]: to = 12 is out of range",
                 [](PoseGraph& g) { g.edges[0].to = 12; }},
        BadGraph{"SameEnds", "edges[2]: both ends",
                 [](PoseGraph& g) { g.edges[2].to = g.edges[2].from; }},
        BadGraph{"PoseNan", "poses[4]: not finite",
                 [](PoseGraph& g) { g.poses[4].translation.x() = kNan; }},
        BadGraph{"PoseNotUnit", "poses[4]: quaternion",
                 [](PoseGraph& g) { g.poses[4].rotation.coeffs() *= 2; }},
        BadGraph{"MeasurementHuge", "edges[5]: from_tform_to: translation exceeds",
                 [](PoseGraph& g) { g.edges[5].from_tform_to.translation.z() = 1e300; }},
        BadGraph{"InformationHuge", "edges[6]: information exceeds",
                 [](PoseGraph& g) { g.edges[6].information *= 1e300; }},
        BadGraph{"MeasurementInfinite", "edges[5]: from_tform_to: not finite",
                 [](PoseGraph& g) {
                   g.edges[5].from_tform_to.translation.z() =
                       std::numeric_limits<double>::infinity();
                 }},
        BadGraph{"MeasurementZeroQuaternion", "edges[5]: from_tform_to: quaternion",
                 [](PoseGraph& g) { g.edges[5].from_tform_to.rotation.coeffs().setZero(); }},
        BadGraph{"InformationNan", "edges[6]: information matrix is not finite",
                 [](PoseGraph& g) { g.edges[6].information(1, 2) = kNan; }},
        BadGraph{"InformationIndefinite", "edges[6]: information matrix is not positive",
                 [](PoseGraph& g) { g.edges[6].information(5, 5) = -1; }},
        BadGraph{"LandmarkNan", "landmarks[2]: not finite",
                 [](PoseGraph& g) { g.landmarks[2].y() = kNan; }},
        BadGraph{"SightingPose", "sightings[1]: pose = 12 is out of range",
                 [](PoseGraph& g) { g.sightings[1].pose = 12; }},
        BadGraph{"SightingLandmark", "sightings[1]: landmark = 3 is out of range",
                 [](PoseGraph& g) { g.sightings[1].landmark = 3; }},
        BadGraph{"SightingNegativeLandmark", "sightings[1]: landmark = -2 is out of range",
                 [](PoseGraph& g) { g.sightings[1].landmark = -2; }},
        BadGraph{"SightingOfNothing", "sightings[1]: target_pose = -1 is out of range",
                 [](PoseGraph& g) { g.sightings[1].landmark = -1; }},
        BadGraph{"SightingOfBoth", "sightings[1]: both a landmark and a target pose",
                 [](PoseGraph& g) { g.sightings[1].target_pose = 3; }},
        BadGraph{"SightingOfItself", "sightings[1]: both ends",
                 [](PoseGraph& g) {
                   g.sightings[1].landmark = -1;
                   g.sightings[1].target_pose = g.sightings[1].pose;
                 }},
        BadGraph{"SightingNan", "sightings[4]: point_in_pose: not finite",
                 [](PoseGraph& g) { g.sightings[4].point_in_pose.x() = kNan; }},
        BadGraph{"SightingTargetHuge", "sightings[4]: point_in_target: translation exceeds",
                 [](PoseGraph& g) { g.sightings[4].point_in_target.x() = 1e300; }},
        BadGraph{"SightingIndefinite", "sightings[4]: information matrix is not positive",
                 [](PoseGraph& g) { g.sightings[4].information(2, 2) = -1; }},
        BadGraph{"InformationAsymmetric", "edges[6]: information matrix is not symmetric",
                 [](PoseGraph& g) { g.edges[6].information(5, 0) = 100; }}),
    [](const auto& info) { return info.param.name; });

TEST(PoseGraphOptimizer, RefusesOptionsOutOfRange) {
  PoseGraphOptimizerOptions options;
  options.num_threads = 0;
  EXPECT_FALSE(OptimizePoseGraph(PoseGraph(), options).ok());
  options = {};
  options.initial_weights = {1};
  EXPECT_FALSE(OptimizePoseGraph(PoseGraph(), options).ok());
  options = {};
  options.initial_sighting_weights = {1};
  EXPECT_FALSE(OptimizePoseGraph(PoseGraph(), options).ok());
  options = {};
  options.sighting_chi_square_limit = 0;
  EXPECT_FALSE(OptimizePoseGraph(PoseGraph(), options).ok());
}

// At the edge of what CheckPoseGraph lets in nothing overflows.
TEST(PoseGraphOptimizer, SurvivesTheLargestNumbersAllowed) {
  PoseGraph graph;
  graph.poses.resize(2);
  graph.edges.push_back({0, 1, Rigid3d(Eigen::Quaterniond::Identity(), {1e15, 0, 0}),
                         1e30 * Matrix6d::Identity(), EdgeKind::kOdometry});
  EXPECT_TRUE(std::isfinite(Optimise(graph).final_cost));
}

}  // namespace
}  // namespace overtone
