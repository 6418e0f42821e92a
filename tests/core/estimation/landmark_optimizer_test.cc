// SPDX-License-Identifier: Apache-2.0
// Point sightings in the optimiser: landmarks, tags carried by other poses, wrong identities.
#include <cmath>

#include "gtest/gtest.h"
#include "overtone/core/estimation/pose_graph_optimizer.h"
#include "overtone/tests/core/estimation/pose_graph_test_support.h"

namespace overtone {
namespace {

constexpr double kSigmaM = 0.05;  // of a sighting, each axis

PoseGraphResult Optimise(const PoseGraph& graph, const PoseGraphOptimizerOptions& options = {}) {
  auto result = OptimizePoseGraph(graph, options);
  EXPECT_TRUE(result.ok()) << result.status();
  return result.ok() ? *result : PoseGraphResult();
}

PoseGraphOptimizerOptions FromOdometry(RobustLoss loss = RobustLoss::kNone) {
  PoseGraphOptimizerOptions options;
  options.initialisation = PoseGraphInitialisation::kSpanningTree;
  options.loss = loss;
  return options;
}

Eigen::Vector3d RandomPoint(std::mt19937& random, double scale) {
  return RandomVector(random, scale).head<3>();
}

// Of unequal axes and correlated: what an observer measures well depends on how it looks.
Eigen::Matrix3d SightingCovariance() {
  Eigen::Matrix3d covariance;
  covariance << 1, 0.3, 0, 0.3, 1, 0, 0, 0, 0.25;
  return kSigmaM * kSigmaM * covariance;
}

PointSighting SeePoint(const Rigid3d& world_from_observer, const Eigen::Vector3d& point_in_world,
                       std::mt19937& random) {
  PointSighting sighting;
  sighting.information = SightingCovariance().inverse();
  const Eigen::Matrix3d root = SightingCovariance().llt().matrixL();
  sighting.point_in_pose =
      world_from_observer.Inverse() * point_in_world + root * RandomPoint(random, 1);
  return sighting;
}

// Every landmark that lies within `range` of a pose is seen from there.
void SeeLandmarks(PoseGraph& graph, double range, std::mt19937& random) {
  for (int i = 0; i < static_cast<int>(graph.poses.size()); ++i) {
    for (int l = 0; l < static_cast<int>(graph.landmarks.size()); ++l) {
      if ((graph.landmarks[l] - graph.poses[i].translation).norm() > range) continue;
      PointSighting sighting = SeePoint(graph.poses[i], graph.landmarks[l], random);
      sighting.pose = i;
      sighting.landmark = l;
      graph.sightings.push_back(sighting);
    }
  }
}

// `rounds` rounds of a circle of 20 poses and 10 m radius: odometry of 1 cm and `yaw_sigma`, no
// closures. Planar unless `climb` lifts and tilts it.
PoseGraph Rounds(int rounds, double climb, double yaw_sigma, std::mt19937& random) {
  PoseGraph graph;
  Vector6d sigma;
  sigma << 0.01, 0.01, 0.01, 0.001, 0.001, yaw_sigma;
  const Matrix6d information = sigma.cwiseAbs2().cwiseInverse().asDiagonal();
  Vector6d step;
  step << M_PI, 0, climb, climb / 10, 0, M_PI / 10;
  graph.poses.push_back(Rigid3d());
  for (int i = 1; i < 20 * rounds; ++i) {
    graph.poses.push_back(graph.poses.back() * Exp(step));
    graph.edges.push_back({i - 1, i, Exp(step) * Exp(RandomVector(random, 1).cwiseProduct(sigma)),
                           information, EdgeKind::kOdometry});
  }
  return graph;
}

// One landmark beside every second pose of the first `num_poses`.
void PlantLandmarks(PoseGraph& graph, int num_poses, std::mt19937& random, double height) {
  for (int i = 0; i < num_poses; i += 2) {
    Eigen::Vector3d beside = RandomPoint(random, 2);
    beside.z() *= height;
    graph.landmarks.push_back(graph.poses[i] * beside);
  }
}

double WorstLandmark(const std::vector<Eigen::Vector3d>& a, const std::vector<Eigen::Vector3d>& b) {
  double worst = 0;
  for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, (a[i] - b[i]).norm());
  return worst;
}

// The law of least squares: the sum of chi squares has as many degrees of freedom as there are
// residuals more than unknowns.
void ExpectChiSquareLaw(const PoseGraph& graph, const PoseGraphResult& result) {
  const double freedom = 6.0 * graph.edges.size() + 3.0 * graph.sightings.size() -
                         6.0 * (graph.poses.size() - 1) - 3.0 * graph.landmarks.size();
  EXPECT_NEAR(2 * result.final_cost, freedom, 4 * std::sqrt(2 * freedom));
}

class LandmarkSlam : public ::testing::TestWithParam<double> {};

TEST_P(LandmarkSlam, RecoversTheTruthThatOdometryAloneLoses) {
  std::mt19937 random(1);
  PoseGraph graph = Rounds(3, /*climb=*/GetParam(), /*yaw_sigma=*/0.03, random);
  const double drift = WorstDistance(Optimise(graph, FromOdometry()).poses, graph.poses);
  PlantLandmarks(graph, 20, random, /*height=*/10 * GetParam());
  SeeLandmarks(graph, 8, random);
  const PoseGraphResult result = Optimise(graph, FromOdometry());
  EXPECT_TRUE(result.converged);
  EXPECT_EQ(result.number_of_components, 1);
  EXPECT_GT(drift, 2);
  EXPECT_LT(WorstDistance(result.poses, graph.poses), 0.1 * drift);
  EXPECT_LT(WorstLandmark(result.landmarks, graph.landmarks), 0.1 * drift);
  ExpectChiSquareLaw(graph, result);
}

INSTANTIATE_TEST_SUITE_P(PlanarAndClimbing, LandmarkSlam, ::testing::Values(0.0, 0.1));

// Two robots on one circle, the second in a frame of its own.
PoseGraph TwoChains(const Rigid3d& world_from_second, std::mt19937& random) {
  PoseGraph graph = Rounds(1, 0, 0.001, random);
  const PoseGraph second = Rounds(1, 0, 0.001, random);
  for (PoseGraphEdge edge : second.edges) {
    edge.from += 20;
    edge.to += 20;
    graph.edges.push_back(edge);
  }
  for (const Rigid3d& pose : second.poses) graph.poses.push_back(world_from_second * pose);
  return graph;
}

// What the optimiser is given: the truth, but the second chain elsewhere and the landmarks nowhere.
PoseGraph Displace(PoseGraph graph) {
  Vector6d away;
  away << 4, -3, 1, 0.1, -0.1, 0.8;
  for (size_t i = 20; i < graph.poses.size(); ++i) graph.poses[i] = Exp(away) * graph.poses[i];
  for (Eigen::Vector3d& landmark : graph.landmarks) landmark.setZero();
  return graph;
}

TEST(PointSightings, LandmarksInCommonMakeTwoChainsOne) {
  std::mt19937 random(2);
  PoseGraph graph = TwoChains(Exp(RandomVector(random, 1)), random);
  PlantLandmarks(graph, 40, random, 1);
  SeeLandmarks(graph, 8, random);
  for (const RobustLoss loss : {RobustLoss::kNone, RobustLoss::kTruncatedLeastSquares}) {
    PoseGraphOptimizerOptions options;
    options.loss = loss;
    const PoseGraphResult result = Optimise(Displace(graph), options);
    EXPECT_EQ(result.number_of_components, 1);
    EXPECT_LT(WorstDistance(result.poses, graph.poses), 0.15);
    EXPECT_LT(WorstLandmark(result.landmarks, graph.landmarks), 0.2);
  }
}

TEST(PointSightings, RobotsThatSeeEachOtherFindTheirRelativePose) {
  std::mt19937 random(3);
  PoseGraph graph = TwoChains(Exp(RandomVector(random, 0.3)), random);
  for (int i = 0; i < 20; ++i) {
    PointSighting sighting;
    const int observer = i % 2 == 0 ? i : 20 + i;
    const int target = i % 2 == 0 ? 20 + i : i;
    const Eigen::Vector3d tag(0.2, 0.1, 0.5);
    sighting = SeePoint(graph.poses[observer], graph.poses[target] * tag, random);
    sighting.pose = observer;
    sighting.target_pose = target;
    sighting.point_in_target = tag;
    graph.sightings.push_back(sighting);
  }
  const PoseGraphResult result = Optimise(Displace(graph));
  EXPECT_EQ(result.number_of_components, 1);
  EXPECT_LT(WorstDistance(result.poses, graph.poses), 0.15);
  ExpectChiSquareLaw(graph, result);
}

// A known landmark cannot be trusted either: a wrong sighting may have put it where it is.
TEST(PointSightings, WrongIdentitiesAreDemotedAndDoNoHarm) {
  std::mt19937 random(4);
  PoseGraph graph = Rounds(3, /*climb=*/0, /*yaw_sigma=*/0.005, random);
  PlantLandmarks(graph, 20, random, 1);
  SeeLandmarks(graph, 8, random);
  auto options = FromOdometry(RobustLoss::kTruncatedLeastSquares);
  const double clean = WorstDistance(Optimise(graph, options).poses, graph.poses);
  PoseGraph spoilt = graph;
  std::vector<bool> wrong;
  for (PointSighting& sighting : spoilt.sightings) {
    wrong.push_back(random() % 10 < 3);
    if (!wrong.back()) continue;
    sighting.landmark = (sighting.landmark + 1 + random() % 9) % 10;
    spoilt.landmarks[sighting.landmark] = graph.poses[sighting.pose] * sighting.point_in_pose;
  }
  for (const auto initialisation :
       {PoseGraphInitialisation::kSpanningTree, PoseGraphInitialisation::kGiven}) {
    options.initialisation = initialisation;
    const PoseGraphResult result = Optimise(spoilt, options);
    int wrong_in_use = 0, right_demoted = 0;
    for (size_t k = 0; k < wrong.size(); ++k) {
      wrong_in_use += wrong[k] && result.sighting_weights[k] > 0;
      right_demoted += !wrong[k] && result.sighting_weights[k] < 1;
      EXPECT_EQ(result.sighting_weights[k], result.sighting_chi_squares[k] <= 16.27);
    }
    EXPECT_EQ(wrong_in_use, 0) << "of " << wrong.size();
    EXPECT_LE(right_demoted, 0.02 * wrong.size());
    EXPECT_LT(WorstDistance(result.poses, graph.poses), 1.5 * clean);
  }
}

// Each kind is held against its own limit: one chi square, two verdicts.
TEST(PointSightings, AreJudgedByTheirOwnLimit) {
  PoseGraph graph;
  graph.poses.resize(2);
  graph.edges.push_back({0, 1, Rigid3d(), 1e8 * Matrix6d::Identity(), EdgeKind::kOdometry});
  const Rigid3d off(Eigen::Quaterniond::Identity(), {std::sqrt(20.0), 0, 0});
  graph.edges.push_back({0, 1, off, Matrix6d::Identity(), EdgeKind::kLoopClosure});
  PointSighting sighting;
  sighting.target_pose = 1;
  sighting.point_in_pose = off.translation;
  graph.sightings.push_back(sighting);
  PoseGraphOptimizerOptions options;
  options.loss = RobustLoss::kTruncatedLeastSquares;
  const PoseGraphResult result = Optimise(graph, options);
  EXPECT_NEAR(result.chi_squares[1], 20, 1e-3);
  EXPECT_NEAR(result.sighting_chi_squares[0], 20, 1e-3);
  EXPECT_EQ(result.weights[1], 1);
  EXPECT_EQ(result.sighting_weights[0], 0);
}

// A world frame as first pose: absolute measurements are closures to it, and it is what stays.
TEST(PointSightings, TheFirstPoseStaysAndAbsoluteMeasurementsMoveTheRest) {
  std::mt19937 random(5);
  PoseGraph graph = Rounds(1, 0, 0.001, random);
  PlantLandmarks(graph, 20, random, 1);
  SeeLandmarks(graph, 8, random);
  graph.poses.insert(graph.poses.begin(), Rigid3d());
  for (PoseGraphEdge& edge : graph.edges) ++edge.from, ++edge.to;
  for (PointSighting& sighting : graph.sightings) ++sighting.pose;
  const Rigid3d world_from_chain = Exp(RandomVector(random, 1));
  for (const int i : {3, 17}) {
    graph.edges.push_back({0, i, world_from_chain * graph.poses[i], 1e4 * Matrix6d::Identity(),
                           EdgeKind::kLoopClosure});
  }
  PoseGraphOptimizerOptions options;
  options.loss = RobustLoss::kTruncatedLeastSquares;
  const PoseGraphResult result = Optimise(graph, options);
  EXPECT_EQ(result.poses[0].translation, Eigen::Vector3d::Zero());
  for (size_t i = 1; i < graph.poses.size(); ++i) {
    EXPECT_LT(Distance(result.poses[i], world_from_chain * graph.poses[i]), 0.1) << i;
  }
  for (size_t l = 0; l < graph.landmarks.size(); ++l) {
    EXPECT_LT((result.landmarks[l] - world_from_chain * graph.landmarks[l]).norm(), 0.15) << l;
  }
}

TEST(PointSightings, ALandmarkThatNothingInUseReachesStaysWhereItIs) {
  std::mt19937 random(6);
  PoseGraph graph = Rounds(1, 0, 0.001, random);
  graph.landmarks = {{1, 2, 3}, {4, 5, 6}};
  PointSighting sighting = SeePoint(graph.poses[0], {0, 0, 0}, random);
  sighting.landmark = 1;
  graph.sightings.push_back(sighting);
  PoseGraphOptimizerOptions options;
  options.loss = RobustLoss::kTruncatedLeastSquares;
  options.initial_sighting_weights = {0};
  const PoseGraphResult result = Optimise(graph, options);
  EXPECT_EQ(result.landmarks, graph.landmarks);
  EXPECT_EQ(result.sighting_weights, std::vector<double>{0});
  EXPECT_EQ(result.number_of_components, 1);
}

// One common point leaves the rotation between two chains open: it must not tear them.
TEST(PointSightings, OneLandmarkInCommonBringsTwoChainsTogetherWithoutBendingThem) {
  std::mt19937 random(7);
  PoseGraph graph = TwoChains(Rigid3d(), random);
  graph.landmarks = {{1, 1, 1}};
  for (const int i : {0, 20}) {
    PointSighting sighting = SeePoint(graph.poses[i], graph.landmarks[0], random);
    sighting.pose = i;
    sighting.landmark = 0;
    graph.sightings.push_back(sighting);
  }
  const PoseGraphResult result = Optimise(Displace(graph));
  EXPECT_LT(result.final_cost, 1e-6);
  EXPECT_TRUE(result.converged);
  for (const PoseGraphEdge& edge : graph.edges) {
    EXPECT_LT(Distance(result.poses[edge.from] * edge.from_tform_to, result.poses[edge.to]), 1e-4);
  }
}

}  // namespace
}  // namespace overtone
