// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/graph_monitor.h"

#include <cmath>
#include <limits>
#include <set>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/core/mapping/map_test_support.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;

// Keyframes along x, `spacing` apart, in one submap; map poses shifted by y metres.
SnapshotMission LineMission(const std::string& robot, int num_keyframes, double spacing, double y,
                            int component = 0) {
  SnapshotMission mission;
  mission.id = Mission(robot);
  mission.component = component;
  mission.anchored = component == 0;
  mission.map_from_mission = Planar(0, y, 0);
  std::vector<Rigid3d> odometry;
  for (int i = 0; i < num_keyframes; ++i) odometry.push_back(Planar(i * spacing, 0, 0));
  mission.keyframes = MakeSubmap(0, 0, odometry).keyframes;
  for (const Rigid3d& pose : odometry) mission.map_from_body.push_back(Planar(0, y, 0) * pose);
  mission.submap_starts = {0};
  return mission;
}

std::vector<int64_t> Indices(const MapMission& mission) {
  std::vector<int64_t> indices;
  for (const MapNode& node : mission.nodes) indices.push_back(node.index);
  return indices;
}

MapGraph Build(const MapSnapshot& snapshot, const GraphMonitorOptions& options) {
  auto graph = BuildMapGraph(snapshot, options);
  EXPECT_TRUE(graph.ok()) << graph.status();
  return graph.ok() ? *graph : MapGraph();
}

TEST(GraphMonitor, DefaultOptionsAreValid) { EXPECT_TRUE(GraphMonitorOptions().Validate().ok()); }

TEST(GraphMonitor, RefusesOptionsOutOfRange) {
  GraphMonitorOptions options;
  options.max_nodes = 0;
  EXPECT_FALSE(BuildMapGraph(MapSnapshot(), options).ok());
  options = {};
  options.min_distance_m = -1;
  EXPECT_FALSE(BuildMapGraph(MapSnapshot(), options).ok());
  options = {};
  options.reduction_tolerance = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(BuildMapGraph(MapSnapshot(), options).ok());
}

TEST(GraphMonitor, AnEmptyMapGivesAnEmptyGraphOfItsRevision) {
  MapSnapshot snapshot;
  snapshot.revision = 4;
  snapshot.map_epoch = 9;
  GraphMonitorOptions options;
  options.include_edges = true;
  const MapGraph graph = Build(snapshot, options);
  EXPECT_EQ(graph.revision, 4);
  EXPECT_EQ(graph.map_epoch, 9);
  EXPECT_TRUE(graph.missions.empty());
}

TEST(GraphMonitor, KeepsOneKeyframePerDistanceAndTheFirstAndLast) {
  MapSnapshot snapshot;
  snapshot.missions = {LineMission("a", 12, 0.25, 3)};
  GraphMonitorOptions options;
  options.min_distance_m = 1;
  const MapGraph graph = Build(snapshot, options);
  ASSERT_EQ(graph.missions.size(), 1);
  EXPECT_THAT(Indices(graph.missions[0]), ElementsAre(0, 4, 8, 11));
  const MapNode& node = graph.missions[0].nodes[1];
  EXPECT_EQ(node.stamp, snapshot.missions[0].keyframes[4].stamp);
  EXPECT_NEAR(node.map_from_body.translation.x(), 1, 1e-12);
  EXPECT_NEAR(node.map_from_body.translation.y(), 3, 1e-12);
  EXPECT_TRUE(graph.edges.empty());
}

// A correction bends the map but not the odometry: robots keep the nodes they know.
TEST(GraphMonitor, NodesDoNotChangeWithTheOptimisedPoses) {
  MapSnapshot snapshot;
  snapshot.missions = {LineMission("a", 40, 0.25, 0)};
  GraphMonitorOptions options;
  options.min_distance_m = 1;
  const auto before = Indices(Build(snapshot, options).missions[0]);
  for (Rigid3d& pose : snapshot.missions[0].map_from_body) pose.translation *= 1.3;
  EXPECT_EQ(Indices(Build(snapshot, options).missions[0]), before);
}

TEST(GraphMonitor, FlagsTheFirstKeptNodeOfASubmapAndEveryDegenerateStretch) {
  MapSnapshot snapshot;
  snapshot.missions = {LineMission("a", 12, 0.25, 0)};
  snapshot.missions[0].submap_starts = {0, 5, 9};
  std::vector<Keyframe> keyframes(snapshot.missions[0].keyframes.begin(),
                                  snapshot.missions[0].keyframes.end());
  keyframes[6].degenerate = true;
  snapshot.missions[0].keyframes = std::move(keyframes);
  GraphMonitorOptions options;
  options.min_distance_m = 1;
  const MapMission mission = Build(snapshot, options).missions[0];  // nodes 0, 4, 8, 11
  std::vector<bool> starts, degenerate;
  for (const MapNode& node : mission.nodes) {
    starts.push_back(node.submap_start);
    degenerate.push_back(node.degenerate);
  }
  EXPECT_THAT(starts, ElementsAre(true, false, true, true));
  EXPECT_THAT(degenerate, ElementsAre(false, false, true, false));
}

// Nodes 1 m apart, radius 1 m: neighbours only, weight exp(-1/2).
TEST(GraphMonitor, EdgesAreTheRadiusGraphs) {
  MapSnapshot snapshot;
  snapshot.missions = {LineMission("a", 3, 1, 0), LineMission("b", 2, 1, 1)};
  GraphMonitorOptions options;
  options.radius_graph.radius_m = 1.1;
  options.include_edges = true;
  const MapGraph graph = Build(snapshot, options);
  std::vector<std::pair<int, int>> pairs;
  for (const MapEdge& edge : graph.edges) {
    pairs.emplace_back(edge.first, edge.second);
    EXPECT_NEAR(edge.weight, std::exp(-0.5), 1e-12);
  }
  EXPECT_THAT(pairs, ElementsAre(std::pair(0, 1), std::pair(0, 3), std::pair(1, 2), std::pair(1, 4),
                                 std::pair(3, 4)));
}

TEST(GraphMonitor, ComponentsThatOverlapByChanceShareNoEdge) {
  MapSnapshot snapshot;
  snapshot.missions = {LineMission("a", 3, 1, 0), LineMission("b", 3, 1, 0, /*component=*/1)};
  GraphMonitorOptions options;
  options.include_edges = true;
  for (const MapEdge& edge : Build(snapshot, options).edges) {
    EXPECT_EQ(edge.first < 3, edge.second < 3) << edge.first << " " << edge.second;
  }
}

TEST(GraphMonitor, AboveTheLimitKeepsThatManyNodesAndTheEndsOfEveryMission) {
  MapSnapshot snapshot;
  snapshot.missions = {LineMission("a", 100, 0.5, 0), LineMission("b", 60, 0.5, 2),
                       LineMission("c", 1, 0.5, 2)};
  GraphMonitorOptions options;
  options.max_nodes = 40;
  const MapGraph graph = Build(snapshot, options);
  EXPECT_EQ(graph.NumNodes(), 40);
  EXPECT_EQ(Indices(graph.missions[0]).front(), 0);
  EXPECT_EQ(Indices(graph.missions[0]).back(), 99);
  EXPECT_EQ(Indices(graph.missions[1]).front(), 0);
  EXPECT_EQ(Indices(graph.missions[1]).back(), 59);
  EXPECT_THAT(Indices(graph.missions[2]), ElementsAre(0));
}

// A chain of unit conductances exp(-1/2): eliminating k nodes between two kept ones leaves 1 / (k +
// 1) of it.
TEST(GraphMonitor, ReducedEdgesAreThoseOfTheKronReduction) {
  MapSnapshot snapshot;
  snapshot.missions = {LineMission("a", 9, 1, 0)};
  GraphMonitorOptions options;
  options.radius_graph.radius_m = 1.1;
  options.max_nodes = 4;
  options.include_edges = true;
  options.reduction_tolerance = 0;
  const MapGraph graph = Build(snapshot, options);
  const auto indices = Indices(graph.missions[0]);
  ASSERT_EQ(indices.size(), 4);
  ASSERT_EQ(graph.edges.size(), 3);
  for (const MapEdge& edge : graph.edges) {
    EXPECT_EQ(edge.second, edge.first + 1);
    const double steps = static_cast<double>(indices[edge.second] - indices[edge.first]);
    EXPECT_NEAR(edge.weight, std::exp(-0.5) / steps, 1e-12);
  }
}

TEST(GraphMonitor, NodesFartherApartThanTheRadiusSurviveTheReduction) {
  MapSnapshot snapshot;
  snapshot.missions = {LineMission("a", 20, 10, 0)};  // no edge at all
  GraphMonitorOptions options;
  options.max_nodes = 5;
  options.include_edges = true;
  const MapGraph graph = Build(snapshot, options);
  EXPECT_EQ(graph.NumNodes(), 20);
  EXPECT_TRUE(graph.edges.empty());
}

}  // namespace
}  // namespace overtone
