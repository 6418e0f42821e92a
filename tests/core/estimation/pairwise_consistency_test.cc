// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/pairwise_consistency.h"

#include <algorithm>
#include <limits>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/core/estimation/inter_mission_world.h"
#include "overtone/tests/core/estimation/pose_graph_test_support.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;

TEST(PairwiseConsistency, DefaultOptionsAreValid) {
  PairwiseConsistencyOptions options;
  EXPECT_TRUE(options.Validate().ok());
  options.chi_square_limit = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(options.Validate().ok());
}

// Standing robots: what remains is two measurements of one relative pose, 3 sigma apart each way.
TEST(ConsistencyChiSquare, OfTwoMeasurementsOfOnePoseIsThatOfTheirDifference) {
  UncertainTrajectory a, b;
  a.Append(Rigid3d(), Matrix6d::Zero());
  b.Append(Rigid3d(), Matrix6d::Zero());
  InterMissionClosure first, second;
  first.from_tform_to.translation.x() = 1;
  second.from_tform_to.translation.x() = 1.3;
  first.covariance = second.covariance = 0.01 * Matrix6d::Identity();
  EXPECT_NEAR(ConsistencyChiSquare(first, second, a, b), 0.3 * 0.3 / 0.02, 1e-9);
}

TEST(ConsistencyChiSquare, IsZeroForExactClosuresAndSymmetric) {
  std::mt19937 random(1);
  const InterMissionWorld world(/*noise=*/0, random);
  for (int trial = 0; trial < 20; ++trial) {
    InterMissionClosure ij = world.RightClosure(random), kl = world.RightClosure(random);
    EXPECT_NEAR(ConsistencyChiSquare(ij, kl, world.a, world.b), 0, 1e-9);
    kl.from_tform_to = kl.from_tform_to * Exp(RandomVector(random, 0.02));
    const double forwards = ConsistencyChiSquare(ij, kl, world.a, world.b);
    EXPECT_GT(forwards, 0.01);
    EXPECT_NEAR(ConsistencyChiSquare(kl, ij, world.a, world.b), forwards, 0.05 * forwards);
  }
}

// The mean of chi square is its degrees of freedom: all four parts count, and count once.
TEST(ConsistencyChiSquare, HasSixDegreesOfFreedomForRightClosures) {
  std::mt19937 random(2);
  double sum = 0;
  constexpr int kSamples = 600;
  for (int s = 0; s < kSamples; ++s) {
    const InterMissionWorld world(/*noise=*/1, random);
    sum += ConsistencyChiSquare(world.RightClosure(random), world.RightClosure(random), world.a,
                                world.b);
  }
  EXPECT_NEAR(sum / kSamples, 6, 4 * std::sqrt(12.0 / kSamples));
}

class OutlierShare : public ::testing::TestWithParam<int> {};

TEST_P(OutlierShare, AllRightClosuresAreKeptAndNoWrongOne) {
  const int wrong_of_100 = GetParam();
  for (const int seed : {3, 4, 5}) {
    std::mt19937 random(seed);
    const InterMissionWorld world(/*noise=*/1, random);
    PairwiseConsistency consistency({});
    std::vector<int> right;
    for (int k = 0; k < 100; ++k) {
      const bool wrong = (k * 37) % 100 < wrong_of_100;
      if (!wrong) right.push_back(k);
      const InterMissionClosure closure =
          wrong ? world.WrongClosure(random) : world.RightClosure(random);
      ASSERT_TRUE(consistency.Add(closure, world.a, world.b).ok());
    }
    const Clique& set = consistency.ConsistentSet();
    EXPECT_EQ(set.members, right) << "seed " << seed;
    EXPECT_TRUE(set.proven_maximum);
  }
}

INSTANTIATE_TEST_SUITE_P(Percent, OutlierShare, ::testing::Values(0, 50, 80));

TEST(PairwiseConsistency, OneByOneIsTheSameAsAllAtOnce) {
  std::mt19937 random(6);
  const InterMissionWorld world(1, random);
  PairwiseConsistency one_by_one({}), at_once({});
  for (int k = 0; k < 60; ++k) {
    const InterMissionClosure closure =
        k % 3 == 0 ? world.RightClosure(random) : world.WrongClosure(random);
    ASSERT_TRUE(one_by_one.Add(closure, world.a, world.b).ok());
    ASSERT_TRUE(at_once.Add(closure, world.a, world.b).ok());
    EXPECT_TRUE(one_by_one.ConsistentSet().proven_maximum);
  }
  EXPECT_EQ(one_by_one.ConsistentSet().members, at_once.ConsistentSet().members);
  EXPECT_EQ(one_by_one.ConsistentSet().members.size(), 20);
}

TEST(PairwiseConsistency, BetweenTwoThatExcludeEachOtherKeepsTheFirst) {
  std::mt19937 random(7);
  const InterMissionWorld world(1, random);
  PairwiseConsistency consistency({});
  ASSERT_TRUE(consistency.Add(world.WrongClosure(random), world.a, world.b).ok());
  EXPECT_THAT(consistency.ConsistentSet().members, ElementsAre(0));
  ASSERT_TRUE(consistency.Add(world.RightClosure(random), world.a, world.b).ok());
  EXPECT_THAT(consistency.ConsistentSet().members, ElementsAre(0));
  ASSERT_TRUE(consistency.Add(world.RightClosure(random), world.a, world.b).ok());
  EXPECT_THAT(consistency.ConsistentSet().members, ElementsAre(1, 2));
  EXPECT_TRUE(consistency.Agree(1, 2));
  EXPECT_TRUE(consistency.Agree(2, 1));
  EXPECT_FALSE(consistency.Agree(0, 1));
}

// Other poses, motions as uncertain as before.
UncertainTrajectory Through(const std::vector<Rigid3d>& poses, const UncertainTrajectory& old) {
  UncertainTrajectory path;
  for (int i = 0; i < old.Size(); ++i) {
    path.Append(poses[i], i == 0 ? Matrix6d::Identity() : old.Covariance(i - 1, i));
  }
  return path;
}

// Odometry off by far more than it says sets right closures against each other; once the poses are
// corrected they agree.
TEST(PairwiseConsistency, RebuildsWhenTheTrajectoriesHaveChanged) {
  std::mt19937 random(8);
  InterMissionWorld world(1, random);
  std::vector<Rigid3d> bent = world.truth_a;
  for (size_t i = bent.size() / 2; i < bent.size(); ++i) bent[i].translation.x() += 20;
  world.a = Through(bent, world.a);
  PairwiseConsistency consistency({});
  for (int k = 0; k < 30; ++k) {
    ASSERT_TRUE(consistency.Add(world.RightClosure(random), world.a, world.b).ok());
  }
  EXPECT_LT(consistency.ConsistentSet().members.size(), 30);
  world.a = Through(world.truth_a, world.a);
  consistency.Rebuild(world.a, world.b);
  EXPECT_EQ(consistency.ConsistentSet().members.size(), 30);
}

TEST(PairwiseConsistency, RefusesWhatItCannotCompare) {
  std::mt19937 random(9);
  const InterMissionWorld world(1, random);
  PairwiseConsistency consistency({});
  InterMissionClosure closure = world.RightClosure(random);
  closure.from = world.a.Size();
  EXPECT_FALSE(consistency.Add(closure, world.a, world.b).ok());
  closure = world.RightClosure(random);
  closure.to = -1;
  EXPECT_FALSE(consistency.Add(closure, world.a, world.b).ok());
  closure = world.RightClosure(random);
  closure.covariance(2, 2) = 0;
  EXPECT_FALSE(consistency.Add(closure, world.a, world.b).ok());
  EXPECT_EQ(consistency.Size(), 0);
  EXPECT_TRUE(consistency.ConsistentSet().members.empty());
}

}  // namespace
}  // namespace overtone
