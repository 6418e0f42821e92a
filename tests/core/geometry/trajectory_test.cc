// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/geometry/trajectory.h"

#include <algorithm>
#include <limits>
#include <random>
#include <set>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/core/geometry/random_poses.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;

constexpr int64_t kToday = 1763776251123456789;

std::vector<Timestamp> At(const std::vector<int64_t>& ns) {
  std::vector<Timestamp> stamps;
  for (const int64_t value : ns) stamps.push_back({value});
  return stamps;
}

TEST(Interpolate, MovesAndTurnsAtConstantRate) {
  const Rigid3d begin(ExpSO3({0, 0, 3}), {0, 0, 0});
  const Rigid3d end(ExpSO3({0, 0, -3}), {4, 8, -4});  // 2 pi - 6 = 0.283 rad apart, across +-pi
  const Trajectory trajectory = {{{kToday}, begin}, {{kToday + 1000000000}, end}};
  const auto pose = Interpolate(trajectory, {kToday + 250000000});
  ASSERT_TRUE(pose.ok()) << pose.status();
  EXPECT_LT((pose->translation - Eigen::Vector3d(1, 2, -1)).norm(), 1e-15);
  const Eigen::Vector3d turned = LogSO3(begin.rotation.conjugate() * pose->rotation);
  EXPECT_NEAR(turned.z(), 0.25 * (2 * 3.14159265358979323846 - 6), 1e-15);
}

TEST(Interpolate, TellsNeighbouringNanosecondsApart) {
  Trajectory trajectory(3);
  for (int i = 0; i < 3; ++i)
    trajectory[i] = {{kToday + i}, Rigid3d({1, 0, 0, 0}, {1.0 * i, 0, 0})};
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(Interpolate(trajectory, {kToday + i})->translation.x(), i);
  }
}

TEST(Interpolate, NeverExtrapolates) {
  const Trajectory one = {{{5}, Rigid3d()}};
  EXPECT_TRUE(Interpolate(one, {5}).ok());
  EXPECT_EQ(Interpolate(one, {4}).status().code(), absl::StatusCode::kOutOfRange);
  EXPECT_EQ(Interpolate(one, {6}).status().code(), absl::StatusCode::kOutOfRange);
  EXPECT_EQ(Interpolate({}, {0}).status().code(), absl::StatusCode::kOutOfRange);
}

TEST(AssociateByTime, ServesTheClosestPairFirst) {
  // 10-11 go together, which leaves 8 with 14: 6 apart.
  EXPECT_THAT(AssociateByTime(At({8, 10}), At({11, 14}), 6e-9),
              ElementsAre(Pair(0, 1), Pair(1, 0)));
  EXPECT_THAT(AssociateByTime(At({8, 10}), At({11, 14}), 5e-9), ElementsAre(Pair(1, 0)));
}

TEST(AssociateByTime, UsesEachStampOnce) {
  EXPECT_THAT(AssociateByTime(At({10, 11, 12}), At({11}), 1), ElementsAre(Pair(1, 0)));
  EXPECT_THAT(AssociateByTime(At({5, 5}), At({5, 5, 5}), 0), testing::SizeIs(2));
}

TEST(AssociateByTime, IncludesTheToleranceItselfButNotANanosecondMore) {
  const auto a = At({kToday}), b = At({kToday + 500000000});
  EXPECT_THAT(AssociateByTime(a, b, 0.5), ElementsAre(Pair(0, 0)));
  EXPECT_THAT(AssociateByTime(a, b, 0.499999999), IsEmpty());
}

TEST(AssociateByTime, DoesNotNeedSortedStamps) {
  EXPECT_THAT(AssociateByTime(At({300, 100, 200}), At({101, 301}), 5e-9),
              ElementsAre(Pair(0, 1), Pair(1, 0)));
}

TEST(AssociateByTime, TakesAnyToleranceAndAnyStamp) {
  const auto ends = At({std::numeric_limits<int64_t>::min(), std::numeric_limits<int64_t>::max()});
  EXPECT_THAT(AssociateByTime(ends, At({0}), 1e300), testing::SizeIs(1));
  EXPECT_THAT(AssociateByTime(ends, ends, 0), testing::SizeIs(2));
  EXPECT_THAT(AssociateByTime(ends, ends, -1), IsEmpty());
  EXPECT_THAT(AssociateByTime(ends, ends, std::numeric_limits<double>::quiet_NaN()), IsEmpty());
  EXPECT_THAT(AssociateByTime({}, ends, 1), IsEmpty());
}

// "Closest first" makes a stable matching: no two stamps within the tolerance would both rather
// have each other.
TEST(AssociateByTime, LeavesNoTwoStampsThatPreferEachOther) {
  std::mt19937 generator(3);
  std::uniform_int_distribution<int64_t> stamp(0, 2000);
  for (int round = 0; round < 50; ++round) {
    std::set<int64_t> distinct;
    while (distinct.size() < 60) distinct.insert(stamp(generator));
    std::vector<int64_t> shuffled(distinct.begin(), distinct.end());
    std::shuffle(shuffled.begin(), shuffled.end(), generator);
    const auto a = At({shuffled.begin(), shuffled.begin() + 25});
    const auto b = At({shuffled.begin() + 25, shuffled.end()});
    const auto pairs = AssociateByTime(a, b, 20e-9);
    std::vector<int> partner_of_a(a.size(), -1), partner_of_b(b.size(), -1);
    for (const auto& [i, j] : pairs) partner_of_a[i] = j, partner_of_b[j] = i;
    const auto gap = [&](int i, int j) { return std::abs(a[i].ns - b[j].ns); };
    for (int i = 0; i < a.size(); ++i) {
      for (int j = 0; j < b.size(); ++j) {
        const bool a_would = partner_of_a[i] < 0 || gap(i, j) < gap(i, partner_of_a[i]);
        const bool b_would = partner_of_b[j] < 0 || gap(i, j) < gap(partner_of_b[j], j);
        EXPECT_FALSE(gap(i, j) <= 20 && a_would && b_would)
            << i << " and " << j << " prefer each other";
      }
    }
  }
}

TEST(PathLength, AddsUpSteps) {
  std::vector<Rigid3d> poses(3);
  poses[1].translation = {3, 4, 0};
  poses[2].translation = {3, 4, 12};
  EXPECT_DOUBLE_EQ(PathLength(poses), 17);
  EXPECT_DOUBLE_EQ(PathLength(Trajectory{{{0}, poses[0]}, {{1}, poses[1]}}), 5);
  EXPECT_EQ(PathLength(std::vector<Rigid3d>()), 0);
}

}  // namespace
}  // namespace overtone
