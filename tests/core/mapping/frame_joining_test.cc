// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/frame_joining.h"

#include <cmath>
#include <random>

#include "gtest/gtest.h"
#include "overtone/core/geometry/rigid_alignment.h"
#include "overtone/tests/core/mapping/map_test_support.h"

namespace overtone {
namespace {

const Rigid3d kUpright = Rigid3d(ExpSO3({0, 0, 2.5}), {30, -20, 4});
const Rigid3d kTilted = Rigid3d(ExpSO3({0.9, -0.4, 2.0}), {30, -20, 4});

double Error(const FrameAlignment& alignment, const Rigid3d& truth) {
  return Log(truth.Inverse() * alignment.older_from_younger).norm();
}

Eigen::Vector3d RandomPoint(std::mt19937& random, double size_m) {
  std::uniform_real_distribution<double> unit(-0.5, 0.5);
  return size_m * Eigen::Vector3d(unit(random), unit(random), unit(random));
}

// In a cube of size_m, seen without error in both frames.
std::vector<PointTie> RightPoints(const Rigid3d& older_from_younger, int n, std::mt19937& random,
                                  double size_m = 30) {
  std::vector<PointTie> points;
  for (int k = 0; k < n; ++k) {
    const Eigen::Vector3d point = RandomPoint(random, size_m);
    points.push_back({older_from_younger * point, point, /*tolerance_m=*/0.5});
  }
  return points;
}

std::vector<PointTie> WrongPoints(int n, std::mt19937& random) {
  std::vector<PointTie> points;
  for (int k = 0; k < n; ++k) {
    points.push_back({RandomPoint(random, 60), RandomPoint(random, 60), 0.5});
  }
  return points;
}

FrameTie Tie(const Rigid3d& older_from_younger, std::mt19937& random) {
  const Rigid3d older_from_i = Planar(10 * RandomPoint(random, 1).x(), 5, 1);
  const Rigid3d younger_from_j = Planar(3, 10 * RandomPoint(random, 1).y(), -2);
  return {older_from_i, younger_from_j,
          older_from_i.Inverse() * older_from_younger * younger_from_j,
          Covariance(0.1, 0.02).inverse()};
}

TEST(AlignFrames, WithoutTiesThereIsNothingToAlignBy) {
  EXPECT_EQ(AlignFrames({}, {}, 22).agreement, 0);
}

TEST(AlignFrames, OneTieIsFulfilled) {
  std::mt19937 random(1);
  const FrameAlignment alignment = AlignFrames({Tie(kTilted, random)}, {}, 22);
  EXPECT_LT(Error(alignment, kTilted), 1e-9);
  EXPECT_EQ(alignment.tie, 0);
  EXPECT_EQ(alignment.points, 0);
  EXPECT_NEAR(alignment.agreement, 1, 1e-9);
}

TEST(AlignFrames, TwoRightTiesOutvoteMoreWrongOnesThatDisagreeAmongThemselves) {
  std::mt19937 random(2);
  std::vector<FrameTie> ties;
  for (int k = 0; k < 4; ++k) {
    ties.push_back(Tie(kUpright * Planar(10 * k + 10, -7 * k, 0.5 * k), random));
  }
  for (int k = 0; k < 2; ++k) ties.push_back(Tie(kUpright, random));
  const FrameAlignment alignment = AlignFrames(ties, {}, 22);
  EXPECT_LT(Error(alignment, kUpright), 1e-9);
  EXPECT_EQ(alignment.tie, 4);
  EXPECT_NEAR(alignment.agreement, 2, 0.05);
}

// Two ties 0.2 m from each other along x at sigma 0.1 m: chi square 4, so 1 + 1 / (1 + 4 / 20). A
// point 0.3 m off at a tolerance of 0.6 m adds 1 / (1 + 1/4), and agrees.
TEST(AlignFrames, AgreementIsTheSumOfTheWeightsOfAllTies) {
  const Matrix6d information = Covariance(0.1, 0.02).inverse();
  const std::vector<FrameTie> ties = {{Rigid3d(), Rigid3d(), Planar(1, 0, 0), information},
                                      {Rigid3d(), Rigid3d(), Planar(1.2, 0, 0), information}};
  const FrameAlignment poses = AlignFrames(ties, {}, /*chi_square_limit=*/20);
  EXPECT_EQ(poses.tie, 0);
  EXPECT_NEAR(poses.agreement, 1 + 1 / 1.2, 1e-9);
  const FrameAlignment both = AlignFrames(ties, {{{1, 5, 0}, {0, 5.3, 0}, 0.6}}, 20);
  EXPECT_NEAR(both.agreement, 1 + 1 / 1.2 + 0.8, 1e-9);
  EXPECT_EQ(both.points, 1);
  EXPECT_EQ(AlignFrames(ties, {{{1, 5, 0}, {0, 5.7, 0}, 0.6}}, 20).points, 0);
}

// The error of a tie is weighed by its information as a full matrix.
TEST(AlignFrames, CorrelationsCount) {
  Matrix6d covariance = Covariance(1, 0.02);
  covariance(0, 1) = covariance(1, 0) = 0.9;
  const Matrix6d information = covariance.inverse();
  const auto agreement = [&](double y) {
    return AlignFrames({{Rigid3d(), Rigid3d(), Rigid3d(), information},
                        {Rigid3d(), Rigid3d(), Planar(1, y, 0), information}},
                       {}, 1)
        .agreement;
  };
  // (1, y) / [[1, 0.9], [0.9, 1]]: 2 / 1.9 and 2 / 0.1.
  EXPECT_NEAR(agreement(1), 1 + 1 / (1 + 2 / 1.9), 1e-9);
  EXPECT_NEAR(agreement(-1), 1 + 1 / (1 + 2 / 0.1), 1e-9);
}

TEST(AlignFrames, PointsDecideBetweenPosesThatDisagree) {
  std::mt19937 random(3);
  const std::vector<FrameTie> ties = {Tie(kUpright * Planar(20, 0, 1), random),
                                      Tie(kUpright, random)};
  // Two points cannot propose, but they vote.
  const FrameAlignment alignment = AlignFrames(ties, RightPoints(kUpright, 2, random), 22);
  EXPECT_LT(Error(alignment, kUpright), 1e-9);
  EXPECT_EQ(alignment.tie, 1);
  EXPECT_EQ(alignment.points, 2);
}

TEST(AlignFrames, PointsOutvoteAWrongPose) {
  std::mt19937 random(4);
  const FrameAlignment alignment =
      AlignFrames({Tie(kUpright * Planar(20, 0, 1), random)}, RightPoints(kUpright, 6, random), 22);
  EXPECT_LT(Error(alignment, kUpright), 1e-6);
  EXPECT_EQ(alignment.tie, -1);
  EXPECT_EQ(alignment.points, 6);
}

TEST(AlignFrames, OfManyTiesASampleProposesAndAllVote) {
  std::mt19937 random(5);
  std::vector<FrameTie> ties;
  for (int k = 0; k < 1000; ++k) ties.push_back(Tie(kUpright, random));
  const FrameAlignment alignment = AlignFrames(ties, {}, 22);
  EXPECT_NEAR(alignment.agreement, 1000, 1e-6);
}

TEST(AlignPoints, RecoversUprightAndTiltedFrames) {
  for (const Rigid3d& truth : {kUpright, kTilted}) {
    std::mt19937 random(6);
    const auto alignment = AlignPoints(RightPoints(truth, 8, random));
    ASSERT_TRUE(alignment.has_value());
    EXPECT_LT(Error(*alignment, truth), 1e-6);
    EXPECT_EQ(alignment->points, 8);
    EXPECT_EQ(alignment->tie, -1);
  }
}

TEST(AlignPoints, FortyPercentMayBeWrong) {
  for (const Rigid3d& truth : {kUpright, kTilted}) {
    for (int seed = 0; seed < 10; ++seed) {
      std::mt19937 random(seed);
      std::vector<PointTie> points = RightPoints(truth, 18, random);
      for (const PointTie& wrong : WrongPoints(12, random)) points.push_back(wrong);
      std::shuffle(points.begin(), points.end(), random);
      const auto alignment = AlignPoints(points);
      ASSERT_TRUE(alignment.has_value()) << seed;
      EXPECT_LT(Error(*alignment, truth), 0.1) << seed;
      EXPECT_GE(alignment->points, 18);
    }
  }
}

// A rotation about z has less to fit noise with, and gravity is known.
TEST(AlignPoints, NoiseDoesNotTiltAnUprightFrame) {
  std::mt19937 random(7);
  std::vector<PointTie> points = RightPoints(kUpright, 12, random);
  for (PointTie& point : points) point.point_in_older += RandomPoint(random, 0.5);
  const auto alignment = AlignPoints(points);
  ASSERT_TRUE(alignment.has_value());
  const Eigen::Vector3d up = alignment->older_from_younger.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_LT((up - Eigen::Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_LT(Error(*alignment, kUpright), 0.2);
}

TEST(AlignPoints, WhereAllAgreeItIsTheLeastSquaresFitToAll) {
  std::mt19937 random(7);
  std::vector<PointTie> points = RightPoints(kUpright, 12, random);
  std::vector<Eigen::Vector3d> older, younger;
  for (PointTie& point : points) {
    point.point_in_older += RandomPoint(random, 0.4);
    older.push_back(point.point_in_older);
    younger.push_back(point.point_in_younger);
  }
  const auto alignment = AlignPoints(points);
  ASSERT_TRUE(alignment.has_value());
  ASSERT_EQ(alignment->points, 12);
  EXPECT_LT(Error(*alignment, *UmeyamaAlignment(younger, older, AlignmentMode::kYawOnly)), 1e-9);
}

TEST(AlignPoints, TwoPointsAreTooFewAndThreeEnough) {
  std::mt19937 random(8);
  EXPECT_FALSE(AlignPoints({}).has_value());
  EXPECT_FALSE(AlignPoints(RightPoints(kUpright, 2, random)).has_value());
  EXPECT_TRUE(AlignPoints(RightPoints(kUpright, 3, random)).has_value());
}

TEST(AlignPoints, TwoRightOnesAmongWrongOnesAreTooFew) {
  std::mt19937 random(9);
  std::vector<PointTie> points = RightPoints(kUpright, 2, random);
  for (const PointTie& wrong : WrongPoints(2, random)) points.push_back(wrong);
  EXPECT_FALSE(AlignPoints(points).has_value());
}

TEST(AlignPoints, ARegionAsSmallAsTheToleranceTellsNoHeading) {
  std::mt19937 random(10);
  EXPECT_FALSE(AlignPoints(RightPoints(kUpright, 20, random, /*size_m=*/0.7)).has_value());
  EXPECT_TRUE(AlignPoints(RightPoints(kUpright, 20, random, /*size_m=*/4)).has_value());
}

std::vector<PointTie> PointsAlong(const Eigen::Vector3d& axis, const Rigid3d& older_from_younger,
                                  double noise_m) {
  std::mt19937 random(11);
  std::vector<PointTie> points;
  for (int k = 0; k < 10; ++k) {
    const Eigen::Vector3d point = 3.0 * k * axis;
    points.push_back({older_from_younger * point + RandomPoint(random, noise_m),
                      point + RandomPoint(random, noise_m), 0.5});
  }
  return points;
}

TEST(AlignPoints, ALevelLineTellsTheHeadingOfAnUprightFrame) {
  const auto alignment = AlignPoints(PointsAlong(Eigen::Vector3d::UnitX(), kUpright, 0));
  ASSERT_TRUE(alignment.has_value());
  EXPECT_LT(Error(*alignment, kUpright), 1e-6);
}

TEST(AlignPoints, AVerticalLineTellsNoHeadingNoisyOrNot) {
  for (const double noise_m : {0.0, 0.1}) {
    EXPECT_FALSE(AlignPoints(PointsAlong(Eigen::Vector3d::UnitZ(), kUpright, noise_m)).has_value())
        << noise_m;
  }
}

// The rotation about the line is open.
TEST(AlignPoints, ALineDoesNotAlignATiltedFrameNoisyOrNot) {
  for (const double noise_m : {0.0, 0.1}) {
    EXPECT_FALSE(AlignPoints(PointsAlong(Eigen::Vector3d::UnitX(), kTilted, noise_m)).has_value())
        << noise_m;
  }
}

// With noise beyond the tolerance: which points agree depends on the sample.
TEST(AlignPoints, TheSamePointsGiveTheSameBits) {
  std::mt19937 random(12);
  std::vector<PointTie> points = RightPoints(kTilted, 100, random);
  for (PointTie& point : points) point.point_in_older += RandomPoint(random, 3);
  const auto first = AlignPoints(points), second = AlignPoints(points);
  ASSERT_TRUE(first.has_value() && second.has_value());
  EXPECT_EQ(first->older_from_younger.ToMatrix(), second->older_from_younger.ToMatrix());
  EXPECT_EQ(first->points, second->points);
}

TEST(AlignPoints, OfThousandsAnEvenSampleIsEnough) {
  std::mt19937 random(13);
  const auto alignment = AlignPoints(RightPoints(kUpright, 2500, random));
  ASSERT_TRUE(alignment.has_value());
  EXPECT_LT(Error(*alignment, kUpright), 1e-6);
  EXPECT_EQ(alignment->points, 834);  // every third
}

}  // namespace
}  // namespace overtone
