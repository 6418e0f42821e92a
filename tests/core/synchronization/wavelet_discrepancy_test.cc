// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/wavelet_discrepancy.h"

#include <cmath>
#include <limits>
#include <random>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/synchronization/trajectory_signal.h"
#include "overtone/tests/support/golden_comparison.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

const MissionId kMission = {"robot", "mission"};

Vector6d Noise(std::mt19937& random, double sigma) {
  std::normal_distribution<double> normal(0, sigma);
  return Vector6d::NullaryExpr([&] { return normal(random); });
}

// A figure of eight of `n` nodes, and a drifted copy of it.
std::vector<Rigid3d> Server(int n) {
  std::vector<Rigid3d> poses;
  for (int i = 0; i < n; ++i) {
    const double t = 4 * M_PI * i / n;
    poses.emplace_back(ExpSO3(Eigen::Vector3d(0.1 * std::cos(t), 0, t)),
                       Eigen::Vector3d(10 * std::sin(t / 2), 6 * std::sin(t), std::cos(t)));
  }
  return poses;
}

std::vector<Rigid3d> Drifted(const std::vector<Rigid3d>& poses, double sigma) {
  std::mt19937 random(7);
  std::vector<Rigid3d> drifted = {poses.front()};
  for (int i = 1; i < poses.size(); ++i) {
    drifted.push_back(drifted.back() * (poses[i - 1].Inverse() * poses[i]) *
                      Exp(Noise(random, sigma)));
  }
  return drifted;
}

MapMission Mission(const MissionId& id, const std::vector<Rigid3d>& poses) {
  MapMission mission;
  mission.id = id;
  for (int i = 0; i < poses.size(); ++i) mission.nodes.push_back({i, {i}, poses[i], false, false});
  return mission;
}

MapGraph Graph(const std::vector<Rigid3d>& poses) {
  MapGraph graph;
  graph.revision = 3;
  graph.map_epoch = 9;
  graph.missions = {Mission(kMission, poses)};
  return graph;
}

std::vector<NodePose> Onboard(const std::vector<Rigid3d>& poses) {
  std::vector<NodePose> nodes;
  for (int i = 0; i < poses.size(); ++i) nodes.push_back({i, {i}, poses[i]});
  return nodes;
}

Eigen::MatrixXd Discrepancy(const std::vector<Rigid3d>& server, const std::vector<Rigid3d>& onboard,
                            const SynchronizationOptions& options) {
  const auto comparison = CompareTrajectories(Graph(server), kMission, Onboard(onboard), options);
  EXPECT_TRUE(comparison.ok()) << comparison.status();
  return comparison->discrepancy;
}

std::vector<SynchronizationOptions> AllMetricsAndSignals() {
  std::vector<SynchronizationOptions> all;
  for (const DistanceMetric metric : {DistanceMetric::kSe3, DistanceMetric::kR3,
                                      DistanceMetric::kSo3, DistanceMetric::kSo3Trace}) {
    for (const SignalKind signal : {SignalKind::kDistance, SignalKind::kSe3Log}) {
      all.emplace_back();
      all.back().graph.metric = metric;
      all.back().signal = signal;
    }
  }
  return all;
}

TEST(TrajectorySignal, OfAQuarterTurnAheadByHand) {
  const std::vector<Rigid3d> poses = {Rigid3d(),
                                      Rigid3d(ExpSO3({0, 0, M_PI / 2}), Eigen::Vector3d(3, 4, 0))};
  const auto distance = [&](DistanceMetric metric) {
    return TrajectorySignal(poses, SignalKind::kDistance, metric, MetricWeights())(1, 0);
  };
  EXPECT_NEAR(distance(DistanceMetric::kR3), 5, 1e-12);
  EXPECT_NEAR(distance(DistanceMetric::kSo3), M_PI / 2, 1e-12);
  EXPECT_NEAR(distance(DistanceMetric::kSo3Trace), 1, 1e-12);  // 1 + 2 cos(90 deg)
  // |rho| = |t| (theta/2) / sin(theta/2), |phi| = theta
  const double rho = 5 * (M_PI / 4) / std::sin(M_PI / 4);
  EXPECT_NEAR(distance(DistanceMetric::kSe3), std::sqrt(rho * rho + M_PI * M_PI / 2), 1e-12);
}

TEST(TrajectorySignal, NormOverTheLogarithmsChannelsIsTheSe3Distance) {
  const std::vector<Rigid3d> poses = Drifted(Server(40), 0.3);
  const MetricWeights weights{Eigen::Vector4d(1, 2, 3, 0.5)};
  const Eigen::MatrixXd log =
      TrajectorySignal(poses, SignalKind::kSe3Log, DistanceMetric::kR3, weights);
  const Eigen::MatrixXd distance =
      TrajectorySignal(poses, SignalKind::kDistance, DistanceMetric::kSe3, weights);
  EXPECT_LT((log.rowwise().norm() - distance).cwiseAbs().maxCoeff(), 1e-9);
  EXPECT_EQ(log.row(0).norm(), 0);
}

TEST(WaveletDiscrepancy, ScalesFallIntoThirds) {
  const auto bands = [](int num_scales) {
    std::vector<int> bands;
    for (int s = 0; s < num_scales; ++s) {
      bands.push_back(static_cast<int>(BandOfScale(s, num_scales)));
    }
    return bands;
  };
  EXPECT_EQ(bands(3), (std::vector<int>{0, 1, 2}));
  EXPECT_EQ(bands(4), (std::vector<int>{0, 0, 1, 2}));
  EXPECT_EQ(bands(5), (std::vector<int>{0, 0, 1, 1, 2}));
  EXPECT_EQ(bands(6), (std::vector<int>{0, 0, 1, 1, 2, 2}));
  EXPECT_EQ(bands(9), (std::vector<int>{0, 0, 0, 1, 1, 1, 2, 2, 2}));
}

TEST(CompareTrajectories, FindsNothingBetweenIdenticalTrajectoriesInAnyFrames) {
  const std::vector<Rigid3d> server = Server(60);
  std::mt19937 random(1);
  const Rigid3d motion = Exp(Noise(random, 2));
  std::vector<Rigid3d> onboard;
  for (const Rigid3d& pose : server) onboard.push_back(motion * pose);
  for (const SynchronizationOptions& options : AllMetricsAndSignals()) {
    EXPECT_LT(Discrepancy(server, onboard, options).maxCoeff(), 1e-9);
  }
}

TEST(CompareTrajectories, DoesNotDependOnEitherFrame) {
  const std::vector<Rigid3d> server = Server(60), onboard = Drifted(server, 0.05);
  std::mt19937 random(2);
  const Rigid3d server_motion = Exp(Noise(random, 2)), onboard_motion = Exp(Noise(random, 2));
  std::vector<Rigid3d> moved_server, moved_onboard;
  for (const Rigid3d& pose : server) moved_server.push_back(server_motion * pose);
  for (const Rigid3d& pose : onboard) moved_onboard.push_back(onboard_motion * pose);
  for (const SynchronizationOptions& options : AllMetricsAndSignals()) {
    const Eigen::MatrixXd before = Discrepancy(server, onboard, options);
    const Eigen::MatrixXd after = Discrepancy(moved_server, moved_onboard, options);
    EXPECT_GT(before.maxCoeff(), 0.1);
    EXPECT_LT((before - after).cwiseAbs().maxCoeff(), 1e-8);
  }
}

// All of the robot's nodes turn about the origin: no distance from it changes, the logarithm does.
TEST(CompareTrajectories, OnlyTheLogarithmSeesDriftAroundTheOrigin) {
  const std::vector<Rigid3d> server = Server(60);
  std::vector<Rigid3d> onboard = {server.front()};
  const Rigid3d turn = server.front() * Rigid3d(ExpSO3({0, 0, 0.2}), Eigen::Vector3d::Zero()) *
                       server.front().Inverse();
  for (int i = 1; i < server.size(); ++i) onboard.push_back(turn * server[i]);
  SynchronizationOptions options;
  options.graph.metric = DistanceMetric::kR3;
  EXPECT_LT(Discrepancy(server, onboard, options).maxCoeff(), 1e-9);
  options.signal = SignalKind::kSe3Log;
  EXPECT_GT(Discrepancy(server, onboard, options).maxCoeff(), 0.1);
}

TEST(CompareTrajectories, ReportsWhatItCompared) {
  const std::vector<Rigid3d> server = Server(10);
  MapGraph graph = Graph(server);
  graph.missions[0].nodes[3].submap_start = true;
  graph.missions[0].nodes[7].degenerate = true;
  std::vector<NodePose> onboard = Onboard(server);
  onboard.erase(onboard.begin() + 3);            // the submap's start goes to node 4
  onboard.push_back({12, {12}, server.back()});  // not mapped yet
  const auto comparison = CompareTrajectories(graph, kMission, onboard, SynchronizationOptions());
  ASSERT_TRUE(comparison.ok()) << comparison.status();
  EXPECT_EQ(comparison->keyframe_index, (std::vector<int64_t>{0, 1, 2, 4, 5, 6, 7, 8, 9}));
  EXPECT_TRUE(comparison->submap_start[3]);
  EXPECT_FALSE(comparison->submap_start[4]);
  EXPECT_TRUE(comparison->degenerate[6]);
  ASSERT_EQ(comparison->unmatched.size(), 1);
  EXPECT_EQ(comparison->unmatched[0].index, 12);
  EXPECT_EQ(comparison->revision, 3);
  EXPECT_EQ(comparison->map_epoch, 9);
}

TEST(CompareTrajectories, EdgesOfTheGraphReplaceTheRadiusGraph) {
  const std::vector<Rigid3d> server = Server(30), onboard = Drifted(server, 0.05);
  MapGraph graph = Graph(server);
  const SynchronizationOptions options;
  const auto rule = RadiusGraphAdjacency(server, options.graph);
  ASSERT_TRUE(rule.ok());
  for (int j = 0; j < 30; ++j) {
    for (int i = 0; i < j; ++i) {
      if (rule->coeff(i, j) > 0) graph.edges.push_back({i, j, rule->coeff(i, j)});
    }
  }
  const auto same = CompareTrajectories(graph, kMission, Onboard(onboard), options);
  ASSERT_TRUE(same.ok()) << same.status();
  EXPECT_LT((same->discrepancy - Discrepancy(server, onboard, options)).cwiseAbs().maxCoeff(),
            1e-9);
  for (MapEdge& edge : graph.edges) edge.weight *= edge.second % 3 + 1;
  const auto other = CompareTrajectories(graph, kMission, Onboard(onboard), options);
  ASSERT_TRUE(other.ok()) << other.status();
  EXPECT_GT((other->discrepancy - same->discrepancy).cwiseAbs().maxCoeff(), 1e-3);
  graph.edges.push_back({2, 30, 1});
  EXPECT_EQ(CompareTrajectories(graph, kMission, Onboard(onboard), options).status().code(),
            absl::StatusCode::kInvalidArgument);
}

// Another robot's nodes count with the option only, and only those of our own component.
TEST(CompareTrajectories, OtherRobotsCarryTheWaveletsOnRequest) {
  const std::vector<Rigid3d> server = Server(30), onboard = Drifted(server, 0.05);
  const Eigen::MatrixXd alone = Discrepancy(server, onboard, SynchronizationOptions());
  std::vector<Rigid3d> nearby;
  for (const Rigid3d& pose : Server(20)) {
    nearby.push_back(Rigid3d(Eigen::Quaterniond::Identity(), {1, 0, 0}) * pose);
  }
  MapGraph graph = Graph(server);
  graph.missions.insert(graph.missions.begin(), Mission({"another", "mission"}, nearby));
  const auto compare = [&](bool multi_robot) {
    SynchronizationOptions options;
    options.multi_robot_graph = multi_robot;
    const auto comparison = CompareTrajectories(graph, kMission, Onboard(onboard), options);
    EXPECT_TRUE(comparison.ok()) << comparison.status();
    return comparison->discrepancy;
  };
  EXPECT_LT((compare(false) - alone).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_EQ(compare(true).rows(), 30);
  EXPECT_GT((compare(true) - alone).cwiseAbs().maxCoeff(), 1e-3);
  graph.missions[0].component = 1;
  EXPECT_LT((compare(true) - alone).cwiseAbs().maxCoeff(), 1e-9);
}

TEST(CompareTrajectories, RefusesWhatItCannotCompare) {
  const std::vector<Rigid3d> server = Server(19);  // no two nodes in the crossing
  const auto expect_refused =
      [](const MapGraph& graph, const MissionId& mission, const std::vector<NodePose>& onboard,
         const SynchronizationOptions& options, absl::StatusCode code, const std::string& message) {
        const auto comparison = CompareTrajectories(graph, mission, onboard, options);
        EXPECT_EQ(comparison.status().code(), code) << message;
        EXPECT_THAT(std::string(comparison.status().message()), HasSubstr(message));
      };
  const SynchronizationOptions options;
  const std::vector<NodePose> onboard = Onboard(server);
  for (int n = 0; n < 3; ++n) {
    expect_refused(Graph(server), kMission, Onboard(Server(n)), options,
                   absl::StatusCode::kFailedPrecondition, std::to_string(n) + " nodes in common");
  }
  expect_refused(Graph(server), {"robot", "other"}, onboard, options, absl::StatusCode::kNotFound,
                 "robot/other");
  SynchronizationOptions narrow;
  narrow.graph.radius_m = 1e-3;
  expect_refused(Graph(server), kMission, onboard, narrow, absl::StatusCode::kFailedPrecondition,
                 "radius_m");
  std::vector<NodePose> broken = onboard;
  broken[4].estimate_from_body.translation.x() = std::numeric_limits<double>::infinity();
  expect_refused(Graph(server), kMission, broken, options, absl::StatusCode::kInvalidArgument,
                 "keyframe 4");
  MapGraph not_finite = Graph(server);
  not_finite.missions[0].nodes[2].map_from_body.translation.x() = std::nan("");
  expect_refused(not_finite, kMission, onboard, options, absl::StatusCode::kInvalidArgument,
                 "not finite");
}

TEST(SynchronizationOptions, DefaultsAreValidAndBadMembersAreNamed) {
  EXPECT_TRUE(SynchronizationOptions().Validate().ok());
  const auto expect_named = [](auto change, const std::string& member) {
    SynchronizationOptions options;
    change(options);
    EXPECT_EQ(options.Validate().code(), absl::StatusCode::kInvalidArgument) << member;
    EXPECT_THAT(std::string(options.Validate().message()), HasSubstr(member));
  };
  expect_named([](auto& o) { o.graph.radius_m = 0; }, "radius_m");
  expect_named([](auto& o) { o.wavelets.num_scales = 2; }, "num_scales");
  expect_named([](auto& o) { o.signal_weights.diagonal[1] = std::nan(""); }, "signal_weights");
  expect_named([](auto& o) { o.association_tolerance_s = -1; }, "association_tolerance_s");
  expect_named([](auto& o) { o.selection.n = 0; }, "selection.n");
  expect_named([](auto& o) { o.selection.min_discrepancy = std::nan(""); }, "min_discrepancy");
  expect_named([](auto& o) { o.constraints.mid_hops = 0; }, "mid_hops");
  expect_named([](auto& o) { o.constraints.large_max_distance_m = 1; }, "large_max_distance_m");
  expect_named([](auto& o) { o.constraints.sigma_rotation_rad = 0; }, "sigma_rotation_rad");
  expect_named([](auto& o) { o.constraints.min_translation_change_m = -1; }, "min_translation");
}

void ExpectMatchesPrototype(const golden::Case& c) {
  const auto server = golden::ReadPoses(c.File("poses_server.csv"));
  const auto robot = golden::ReadPoses(c.File("poses_robot.csv"));
  const golden::Table signals(c.File("signals.csv"));
  const auto expect_signal = [&](const std::vector<golden::Pose>& poses,
                                 const MetricWeights& weights, const std::string& column) {
    const Eigen::VectorXd expected = signals.Column(column);
    const Eigen::MatrixXd signal = TrajectorySignal(golden::Rigid(poses), SignalKind::kDistance,
                                                    c.graph_options().metric, weights);
    EXPECT_LT((signal.col(0) - expected).cwiseAbs().maxCoeff(), 1e-10) << column;
  };
  expect_signal(server, PrototypeSignalWeights(), "f_server");
  expect_signal(robot, PrototypeSignalWeights(), "h_robot");
  for (const int num_scales : {6, 9}) {
    const std::string file = "features_s" + std::to_string(num_scales) + ".csv";
    if (!c.Has(file)) continue;
    const golden::Table features(c.File(file));
    const auto comparison =
        CompareTrajectories(golden::Graph(server), kMission, golden::Trajectory(robot),
                            golden::PrototypeOptions(c, num_scales));
    ASSERT_TRUE(comparison.ok()) << comparison.status();
    const std::vector<std::string> columns = {"low", "mid", "high"};
    for (int band = 0; band < 3; ++band) {
      const Eigen::VectorXd expected = features.Column(columns[band]);
      const Eigen::VectorXd error = (comparison->discrepancy.col(band) - expected).cwiseAbs();
      EXPECT_LT((error.array() / (1 + expected.array())).maxCoeff(), 1e-10) << columns[band];
    }
  }
}

TEST(CompareTrajectories, MatchesThePrototypesFeatures) {
  const std::vector<golden::Case> cases = golden::CasesIn(golden::SharedFolder());
  if (cases.empty()) GTEST_SKIP() << "no golden vectors in " << golden::SharedFolder();
  for (const golden::Case& c : cases) {
    SCOPED_TRACE(c.name());
    ExpectMatchesPrototype(c);
  }
}

}  // namespace
}  // namespace overtone
