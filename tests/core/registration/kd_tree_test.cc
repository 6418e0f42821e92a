// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/registration/kd_tree.h"

#include <algorithm>
#include <numeric>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/simulation/random.h"

namespace overtone {
namespace {

std::vector<Eigen::Vector3f> RandomPoints(int n, uint64_t seed) {
  Random random(seed);
  std::vector<Eigen::Vector3f> points;
  for (int i = 0; i < n; ++i) points.push_back(random.Normal3().cast<float>());
  return points;
}

std::vector<int> NearestByExhaustion(const std::vector<Eigen::Vector3f>& points,
                                     const Eigen::Vector3f& query, int k) {
  std::vector<int> indices(points.size());
  std::iota(indices.begin(), indices.end(), 0);
  std::partial_sort(indices.begin(), indices.begin() + k, indices.end(), [&](int a, int b) {
    return (points[a] - query).squaredNorm() < (points[b] - query).squaredNorm();
  });
  indices.resize(k);
  return indices;
}

TEST(KdTree, FindsWhatExhaustiveSearchFinds) {
  const auto points = RandomPoints(500, 1);
  const KdTree tree(points);
  for (const Eigen::Vector3f& query : RandomPoints(100, 2)) {
    const std::vector<int> expected = NearestByExhaustion(points, query, 7);
    std::vector<int> found(7);
    ASSERT_EQ(tree.Nearest(query, absl::MakeSpan(found)), 7);
    EXPECT_EQ(found, expected);
    EXPECT_EQ(tree.Nearest(query, 100).index, expected[0]);
  }
}

TEST(KdTree, FindsNothingBeyondTheGivenDistance) {
  const std::vector<Eigen::Vector3f> points = {{3, 4, 0}};
  const KdTree tree(points);
  EXPECT_EQ(tree.Nearest(Eigen::Vector3f::Zero(), 24.9f).index, -1);
  EXPECT_EQ(tree.Nearest(Eigen::Vector3f::Zero(), 25.1f).index, 0);
  EXPECT_EQ(tree.Nearest(Eigen::Vector3f::Zero(), 25.1f).squared_distance, 25);
}

TEST(KdTree, GivesAllPointsWhenAskedForMore) {
  const std::vector<Eigen::Vector3f> points = {{2, 0, 0}, {1, 0, 0}};
  const KdTree tree(points);
  std::vector<int> found(5, -1);
  EXPECT_EQ(tree.Nearest(Eigen::Vector3f::Zero(), absl::MakeSpan(found)), 2);
  EXPECT_THAT(found, testing::ElementsAre(1, 0, -1, -1, -1));
}

}  // namespace
}  // namespace overtone
