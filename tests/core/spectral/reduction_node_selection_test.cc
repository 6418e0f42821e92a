// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/spectral/reduction_node_selection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "overtone/core/spectral/kron_reduction.h"
#include "overtone/tests/support/synthetic_graph.h"

namespace overtone {
namespace {

using testing::ElementsAre;
using testing::IsSupersetOf;

NodeSelectionOptions Rule(NodeSelectionRule rule) {
  NodeSelectionOptions options;
  options.rule = rule;
  return options;
}

// The largest eigenvector of a star sits on its hub.
TEST(SelectNodes, KeepsTheHubOfAStarByEitherRule) {
  for (const auto rule :
       {NodeSelectionRule::kLargestEigenvector, NodeSelectionRule::kLocalDegree}) {
    const auto kept = SelectNodes(StarGraphLaplacian(8), 1, {}, Rule(rule));
    ASSERT_TRUE(kept.ok()) << kept.status();
    EXPECT_THAT(*kept, ElementsAre(0));
  }
}

TEST(SelectNodes, ReturnsTheNumberAskedForIncreasingWithWhatMustNotGo) {
  const SparseMatrix laplacian = MakeSyntheticTeam(1000).Laplacian();
  const std::vector<int> always = {999, 199, 7, 399};
  const auto kept = SelectNodes(laplacian, 300, always, {});
  ASSERT_TRUE(kept.ok()) << kept.status();
  EXPECT_EQ(kept->size(), 300);
  EXPECT_THAT(*kept, IsSupersetOf(always));
  EXPECT_TRUE(std::is_sorted(kept->begin(), kept->end()));
  EXPECT_TRUE(KronReduction(laplacian, *kept).ok());
}

TEST(SelectNodes, LocalDegreeLeavesNoLongStretchWithoutANode) {
  const SparseMatrix laplacian = MakeSyntheticTeam(1000).Laplacian();
  const auto kept = SelectNodes(laplacian, 400, {}, Rule(NodeSelectionRule::kLocalDegree));
  ASSERT_TRUE(kept.ok()) << kept.status();
  for (size_t i = 1; i < kept->size(); ++i)
    EXPECT_LE((*kept)[i] - (*kept)[i - 1], 14) << "after " << (*kept)[i - 1];
}

TEST(SelectNodes, LocalDegreeAgreesWithTheEigenvectorRuleBetterThanChance) {
  const SparseMatrix laplacian = MakeSyntheticTeam(500).Laplacian();
  const auto exact = SelectNodes(laplacian, 300, {}, Rule(NodeSelectionRule::kLargestEigenvector));
  const auto local = SelectNodes(laplacian, 300, {}, Rule(NodeSelectionRule::kLocalDegree));
  ASSERT_TRUE(exact.ok() && local.ok());
  std::vector<int> shared;
  std::set_intersection(exact->begin(), exact->end(), local->begin(), local->end(),
                        std::back_inserter(shared));
  EXPECT_GT(shared.size(), 0.66 * 300);  // chance: 0.6
}

TEST(SelectNodes, LeavesNoComponentWithoutANode) {
  // Three pairs and an isolated node; one asked for.
  const SparseMatrix laplacian = LaplacianOfEdges(7, {{0, 1, 1}, {2, 3, 2}, {4, 5, 3}});
  const auto kept = SelectNodes(laplacian, 1, {3}, {});
  ASSERT_TRUE(kept.ok()) << kept.status();
  EXPECT_EQ(kept->size(), 4);
  EXPECT_TRUE(KronReduction(laplacian, *kept).ok());
}

TEST(SelectNodes, RefusesBadArguments) {
  const SparseMatrix path = PathGraphLaplacian(4);
  EXPECT_TRUE(absl::IsInvalidArgument(SelectNodes(path, 0, {}, {}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(SelectNodes(path, 5, {}, {}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(SelectNodes(path, 2, {4}, {}).status()));
  EXPECT_TRUE(absl::IsInvalidArgument(SelectNodes(SparseMatrix(2, 3), 1, {}, {}).status()));
}

}  // namespace
}  // namespace overtone
