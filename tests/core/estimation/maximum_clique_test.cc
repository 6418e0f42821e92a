// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/maximum_clique.h"

#include <algorithm>
#include <random>
#include <utility>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/estimation/core_order.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

BitGraph MakeGraph(int num_nodes, const std::vector<std::pair<int, int>>& edges) {
  BitGraph graph(num_nodes);
  for (const auto& [a, b] : edges) graph.Connect(a, b);
  return graph;
}

BitGraph RandomGraph(int num_nodes, double density, std::mt19937& random) {
  BitGraph graph(num_nodes);
  std::uniform_real_distribution<double> uniform(0, 1);
  for (int a = 0; a < num_nodes; ++a) {
    for (int b = 0; b < a; ++b) {
      if (uniform(random) < density) graph.Connect(a, b);
    }
  }
  return graph;
}

// Every two nodes of `planted` are connected.
std::vector<int> Plant(int size, BitGraph& graph, std::mt19937& random) {
  std::vector<int> planted(graph.NumNodes());
  for (int i = 0; i < graph.NumNodes(); ++i) planted[i] = i;
  std::shuffle(planted.begin(), planted.end(), random);
  planted.resize(size);
  std::sort(planted.begin(), planted.end());
  for (const int a : planted) {
    for (const int b : planted) {
      if (a != b) graph.Connect(a, b);
    }
  }
  return planted;
}

bool IsClique(const BitGraph& graph, const std::vector<int>& nodes) {
  for (const int a : nodes) {
    for (const int b : nodes) {
      if (a != b && !graph.AreConnected(a, b)) return false;
    }
  }
  return true;
}

// By looking at every subset of the first `num_nodes` nodes.
int LargestCliqueByEnumeration(const BitGraph& graph, int num_nodes) {
  int largest = 0;
  for (int subset = 0; subset < (1 << num_nodes); ++subset) {
    const int size = __builtin_popcount(subset);
    if (size <= largest) continue;
    std::vector<int> nodes;
    for (int i = 0; i < num_nodes; ++i) {
      if (subset >> i & 1) nodes.push_back(i);
    }
    if (IsClique(graph, nodes)) largest = size;
  }
  return largest;
}

// Without any bound: adds the common neighbours above the last member, one after the other.
int LargestCliqueByRecursion(const BitGraph& graph, const BitSet& candidates) {
  int largest = 0;
  BitSet left = candidates;
  for (const int node : candidates.Elements()) {
    left.Erase(node);
    BitSet common = left;
    common.Intersect(graph.Neighbours(node));
    largest = std::max(largest, 1 + LargestCliqueByRecursion(graph, common));
  }
  return largest;
}

BitSet AllNodes(const BitGraph& graph) {
  BitSet all(graph.NumNodes());
  for (int i = 0; i < graph.NumNodes(); ++i) all.Insert(i);
  return all;
}

void ExpectProven(const Clique& clique) {
  EXPECT_TRUE(clique.proven_maximum);
  EXPECT_EQ(clique.upper_bound, static_cast<int>(clique.members.size()));
}

TEST(MaximumClique, DefaultOptionsAreValidAndANegativeBudgetIsNot) {
  CliqueOptions options;
  EXPECT_TRUE(options.Validate().ok());
  options.max_branches = -1;
  EXPECT_FALSE(options.Validate().ok());
}

TEST(MaximumClique, OfNothingIsNothingAndWithoutEdgesOneNode) {
  const Clique none = MaximumClique(BitGraph(), {}, {});
  EXPECT_THAT(none.members, IsEmpty());
  ExpectProven(none);
  const Clique one = MaximumClique(BitGraph(3), {}, {});
  EXPECT_EQ(one.members.size(), 1);
  ExpectProven(one);
}

// A square with one diagonal, and a tail: 0-1-2-3-0, 0-2, 3-4.
TEST(MaximumClique, FindsATriangleInASquareWithADiagonal) {
  const BitGraph graph = MakeGraph(5, {{0, 1}, {1, 2}, {2, 3}, {3, 0}, {0, 2}, {3, 4}});
  const Clique clique = MaximumClique(graph, {}, {});
  EXPECT_EQ(clique.members.size(), 3);
  EXPECT_TRUE(IsClique(graph, clique.members));
  ExpectProven(clique);
}

// The hub has the largest degree but is in no triangle: greed from it fails.
TEST(MaximumClique, IsNotMisledByAHub) {
  BitGraph graph = MakeGraph(12, {{1, 2}, {2, 3}, {1, 3}});
  for (int leaf = 4; leaf < 12; ++leaf) graph.Connect(0, leaf);
  EXPECT_THAT(MaximumClique(graph, {}, {}).members, ElementsAre(1, 2, 3));
}

TEST(MaximumClique, KeepsWhatIsPreferredAmongEquals) {
  const BitGraph graph = MakeGraph(7, {{0, 1}, {1, 2}, {0, 2}, {4, 5}, {5, 6}, {4, 6}});
  EXPECT_THAT(MaximumClique(graph, {4}, {}).members, ElementsAre(4, 5, 6));
  EXPECT_THAT(MaximumClique(graph, {0, 1}, {}).members, ElementsAre(0, 1, 2));
  // 3 is preferred too, but there is a larger one.
  EXPECT_EQ(MaximumClique(graph, {3}, {}).members.size(), 3);
}

TEST(MaximumClique, AgreesWithEnumerationOnSmallGraphs) {
  std::mt19937 random(1);
  for (int trial = 0; trial < 300; ++trial) {
    const int num_nodes = 1 + trial % 14;
    const BitGraph graph = RandomGraph(num_nodes, 0.1 + 0.2 * (trial % 5), random);
    const Clique clique = MaximumClique(graph, {}, {});
    EXPECT_TRUE(IsClique(graph, clique.members));
    EXPECT_EQ(static_cast<int>(clique.members.size()), LargestCliqueByEnumeration(graph, num_nodes))
        << "trial " << trial;
    ExpectProven(clique);
  }
}

// Large enough that greed misses the largest now and then.
TEST(MaximumClique, AgreesWithPlainRecursionWhereGreedIsNotEnough) {
  std::mt19937 random(6);
  CliqueOptions greed_only;
  greed_only.max_branches = 0;
  int missed_by_greed = 0;
  for (int trial = 0; trial < 30; ++trial) {
    const BitGraph graph = RandomGraph(70, 0.5, random);
    const int largest = LargestCliqueByRecursion(graph, AllNodes(graph));
    const Clique clique = MaximumClique(graph, {}, {});
    EXPECT_TRUE(IsClique(graph, clique.members));
    EXPECT_EQ(static_cast<int>(clique.members.size()), largest) << "trial " << trial;
    ExpectProven(clique);
    const Clique greedy = MaximumClique(graph, {}, greed_only);
    missed_by_greed += static_cast<int>(greedy.members.size()) < largest;
    EXPECT_GE(greedy.upper_bound, largest);
  }
  EXPECT_GT(missed_by_greed, 0);
}

TEST(MaximumClique, GrowsNodeByNodeAsIfSearchedAnew) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 60; ++trial) {
    const BitGraph graph = RandomGraph(12, 0.1 + 0.2 * (trial % 5), random);
    Clique known;
    for (int node = 0; node < 12; ++node) {
      known = MaximumCliqueWithOneMore(graph, node, known, {});
      EXPECT_TRUE(IsClique(graph, known.members));
      EXPECT_EQ(static_cast<int>(known.members.size()), LargestCliqueByEnumeration(graph, node + 1))
          << "trial " << trial << ", node " << node;
      ExpectProven(known);
    }
  }
}

TEST(MaximumClique, FindsAPlantedCliqueInALargeGraph) {
  std::mt19937 random(3);
  BitGraph graph = RandomGraph(1500, 0.1, random);
  const std::vector<int> planted = Plant(30, graph, random);
  const Clique clique = MaximumClique(graph, {}, {});
  EXPECT_EQ(clique.members, planted);
  ExpectProven(clique);
}

// 200 nodes of density 0.9 are out of reach within any such budget.
TEST(MaximumClique, SaysHowFarItGotWhenTheBudgetEnds) {
  std::mt19937 random(4);
  BitGraph graph = RandomGraph(200, 0.9, random);
  int last_bound = graph.NumNodes();
  for (const int64_t budget : {0, 10, 1000}) {
    CliqueOptions options;
    options.max_branches = budget;
    const Clique clique = MaximumClique(graph, {}, options);
    EXPECT_TRUE(IsClique(graph, clique.members));
    EXPECT_GE(clique.members.size(), 30);
    EXPECT_FALSE(clique.proven_maximum);
    EXPECT_GT(clique.upper_bound, static_cast<int>(clique.members.size()));
    EXPECT_LE(clique.upper_bound, last_bound);
    EXPECT_LE(clique.branches, budget);
    last_bound = clique.upper_bound;
  }
}

TEST(MaximumClique, BoundsTheLargestFromAboveWhateverTheBudget) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 200; ++trial) {
    const BitGraph graph = RandomGraph(14, 0.5 + 0.1 * (trial % 4), random);
    CliqueOptions options;
    options.max_branches = trial % 3;
    const int largest = LargestCliqueByEnumeration(graph, 14);
    const Clique clique = MaximumClique(graph, {}, options);
    EXPECT_LE(static_cast<int>(clique.members.size()), largest);
    EXPECT_GE(clique.upper_bound, largest);
    EXPECT_EQ(clique.proven_maximum, clique.upper_bound == static_cast<int>(clique.members.size()));
    const Clique before = MaximumCliqueWithOneMore(graph, 0, Clique(), options);
    Clique grown = before;
    for (int node = 1; node < 14; ++node) {
      grown = MaximumCliqueWithOneMore(graph, node, grown, options);
    }
    EXPECT_LE(static_cast<int>(grown.members.size()), largest);
    EXPECT_GE(grown.upper_bound, largest);
  }
}

// A triangle 0 1 2 with a tail 2-3-4: the tail has core number 1, the triangle 2.
TEST(CoreOrder, NumbersTheDensestPartHighest) {
  const BitGraph graph = MakeGraph(5, {{0, 1}, {1, 2}, {0, 2}, {2, 3}, {3, 4}});
  const CoreOrder order = OrderByCore(graph, AllNodes(graph));
  EXPECT_THAT(order.core, ElementsAre(1, 1, 2, 2, 2));
  EXPECT_THAT(std::vector<int>(order.nodes.begin(), order.nodes.begin() + 2), ElementsAre(4, 3));
}

}  // namespace
}  // namespace overtone
