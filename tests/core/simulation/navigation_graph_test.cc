// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/navigation_graph.h"

#include <set>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;

// A square 0 1 2 3 of side 10 with a way out of corner 2 to 4, where a triangle 4 5 6 turns.
NavigationGraph SquareWithLoop() {
  NavigationGraph graph;
  for (const Eigen::Vector2d& position :
       {Eigen::Vector2d(0, 0), Eigen::Vector2d(10, 0), Eigen::Vector2d(10, 10),
        Eigen::Vector2d(0, 10), Eigen::Vector2d(20, 20), Eigen::Vector2d(24, 21),
        Eigen::Vector2d(21, 24)}) {
    graph.AddWaypoint(position);
  }
  const std::pair<int, int> ways[] = {{0, 1}, {1, 2}, {2, 3}, {3, 0},
                                      {2, 4}, {4, 5}, {5, 6}, {6, 4}};
  for (const auto& [a, b] : ways) graph.Connect(a, b);
  return graph;
}

TEST(NavigationGraph, NobodyTurnsOnTheSpot) {
  const NavigationGraph graph = SquareWithLoop();
  EXPECT_THAT(graph.Onward(0, 1), ElementsAre(2));
  EXPECT_THAT(graph.Onward(-1, 1), ElementsAre(0, 2));
  EXPECT_THAT(graph.Onward(1, 2), ElementsAre(3, 4));
}

TEST(NavigationGraph, ADeadEndIsNotDrivable) {
  NavigationGraph graph = SquareWithLoop();
  EXPECT_TRUE(graph.IsDrivable());
  graph.Connect(0, graph.AddWaypoint({-10, 0}));
  EXPECT_FALSE(graph.IsDrivable());
  EXPECT_FALSE(NavigationGraph().IsDrivable());
}

TEST(NavigationGraph, VisitTakesTheShortestWayThatIsDrivable) {
  const NavigationGraph graph = SquareWithLoop();
  EXPECT_THAT(graph.Visit({0, 2}), testing::AnyOf(ElementsAre(0, 1, 2), ElementsAre(0, 3, 2)));
  // Back from the loop's far end: round the loop, not back the way it came.
  const std::vector<int> there_and_back = graph.Visit({1, 4, 2});
  ASSERT_EQ(there_and_back.size(), 7u);
  EXPECT_THAT(std::vector<int>(there_and_back.begin(), there_and_back.begin() + 3),
              ElementsAre(1, 2, 4));
  EXPECT_THAT(std::vector<int>(there_and_back.begin() + 5, there_and_back.end()),
              ElementsAre(4, 2));
  // From 0 by way of 1, 0 again is only to be had round the square.
  EXPECT_THAT(graph.Visit({0, 1, 0}), ElementsAre(0, 1, 2, 3, 0));
}

TEST(NavigationGraph, ExploringCoversEveryWayAndKeepsToThem) {
  const NavigationGraph graph = SquareWithLoop();
  for (uint64_t seed = 0; seed < 20; ++seed) {
    Random random(seed);
    std::vector<int> walk = {0};
    graph.Explore(300, random, &walk);
    EXPECT_GE(graph.Length(walk), 300);
    EXPECT_LT(graph.Length(walk), 320);
    std::set<std::pair<int, int>> taken;
    for (size_t i = 1; i < walk.size(); ++i) {
      taken.insert(std::minmax(walk[i - 1], walk[i]));
      if (i == 1) continue;
      EXPECT_THAT(graph.Onward(walk[i - 2], walk[i - 1]), testing::Contains(walk[i]));
    }
    EXPECT_EQ(taken.size(), graph.ways().size()) << "seed " << seed;
  }
}

TEST(NavigationGraph, DistanceIsToTheNearestWay) {
  EXPECT_DOUBLE_EQ(SquareWithLoop().DistanceToWay({4, 3}), 3);
  EXPECT_DOUBLE_EQ(SquareWithLoop().DistanceToWay({-3, -4}), 5);
}

}  // namespace
}  // namespace overtone
