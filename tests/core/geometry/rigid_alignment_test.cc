// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/geometry/rigid_alignment.h"

#include <cmath>
#include <limits>
#include <tuple>

#include "gtest/gtest.h"
#include "overtone/tests/core/geometry/random_poses.h"

namespace overtone {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points Cloud(RandomPoses& random, int size, double sigma) {
  Points points;
  for (int i = 0; i < size; ++i) points.push_back(random.Vector(sigma));
  return points;
}

Points Moved(const Rigid3d& motion, const Points& points) {
  Points moved;
  for (const Eigen::Vector3d& point : points) moved.push_back(motion * point);
  return moved;
}

double SumOfSquares(const Rigid3d& motion, const Points& source, const Points& target) {
  double sum = 0;
  for (size_t i = 0; i < source.size(); ++i) sum += (target[i] - motion * source[i]).squaredNorm();
  return sum;
}

double Difference(const Rigid3d& a, const Rigid3d& b) {
  return (a.ToMatrix() - b.ToMatrix()).cwiseAbs().maxCoeff();
}

TEST(UmeyamaAlignment, RecoversAnyMotionOfThreePointsOrMore) {
  RandomPoses random(1);
  for (const int size : {3, 4, 100}) {
    const Points source = Cloud(random, size, 10);
    const Rigid3d motion = random.Pose(100);
    const auto found = UmeyamaAlignment(source, Moved(motion, source), AlignmentMode::kSe3);
    ASSERT_TRUE(found.ok()) << found.status();
    EXPECT_LT(Difference(*found, motion), 1e-11);
  }
}

TEST(UmeyamaAlignment, YawOnlyRecoversATurnAboutZ) {
  RandomPoses random(2);
  const Points source = Cloud(random, 10, 10);
  const Rigid3d motion(ExpSO3({0, 0, -2.5}), {10, -20, 30});
  const auto found = UmeyamaAlignment(source, Moved(motion, source), AlignmentMode::kYawOnly);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_LT(Difference(*found, motion), 1e-12);
}

TEST(UmeyamaAlignment, YawOnlyNeverTilts) {
  RandomPoses random(3);
  const Points source = Cloud(random, 10, 10);
  const Rigid3d tilted(ExpSO3({0.3, 0.2, 1}), {1, 2, 3});
  const auto found = UmeyamaAlignment(source, Moved(tilted, source), AlignmentMode::kYawOnly);
  ASSERT_TRUE(found.ok()) << found.status();
  EXPECT_EQ(found->rotation.x(), 0);
  EXPECT_EQ(found->rotation.y(), 0);
}

// With noise there is no exact answer, but no motion nearby may be better.
TEST(UmeyamaAlignment, IsTheLeastSquaresMinimum) {
  RandomPoses random(4);
  const Points source = Cloud(random, 30, 5);
  Points target = Moved(Rigid3d(ExpSO3({0.1, 0.2, 2}), {1, 2, 3}), source);
  for (Eigen::Vector3d& point : target) point += random.Vector(0.5);
  for (const AlignmentMode mode : {AlignmentMode::kSe3, AlignmentMode::kYawOnly}) {
    const auto found = UmeyamaAlignment(source, target, mode);
    ASSERT_TRUE(found.ok()) << found.status();
    const double least = SumOfSquares(*found, source, target);
    for (int k = 0; k < 6; ++k) {
      const bool free = mode == AlignmentMode::kSe3 || k < 3 || k == 5;
      for (const double step : {-1e-3, 1e-3}) {
        if (!free) continue;

        EXPECT_GT(SumOfSquares(Exp(step * Vector6d::Unit(k)) * *found, source, target), least);
      }
    }
  }
}

TEST(UmeyamaAlignment, AnswersAMirrorImageWithARotation) {
  const Points source = {{3, 0, 0}, {-3, 0, 0}, {0, 2, 0}, {0, -2, 0}, {0, 0, 1}, {0, 0, -1}};
  Points target = source;
  for (Eigen::Vector3d& point : target) point.x() = -point.x();
  const auto found = UmeyamaAlignment(source, target, AlignmentMode::kSe3);
  ASSERT_TRUE(found.ok()) << found.status();
  // The best that turning can do: a half turn about y, which leaves the weakest axis, z, upside
  // down.
  EXPECT_NEAR(std::abs(found->rotation.y()), 1, 1e-12);
  EXPECT_NEAR(SumOfSquares(*found, source, target), 4 + 4, 1e-12);
}

TEST(UmeyamaAlignment, RefusesWhatLeavesTheRotationOpen) {
  const Points line = {{0, 0, 0}, {1, 2, 3}, {2, 4, 6}, {-1, -2, -3}};
  const Points point(5, Eigen::Vector3d(1e6, 2, 3));
  const Points cube = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  Points mirrored = cube;
  for (Eigen::Vector3d& corner : mirrored) corner.x() = -corner.x();
  const Points vertical = {{1, 1, 0}, {1, 1, 5}, {1, 1, 9}};
  const std::vector<std::tuple<Points, Points, AlignmentMode>> cases = {
      {{}, {}, AlignmentMode::kSe3},
      {{}, {}, AlignmentMode::kYawOnly},
      {line, line, AlignmentMode::kSe3},
      {point, point, AlignmentMode::kSe3},
      {point, point, AlignmentMode::kYawOnly},
      {{{0, 0, 0}, {1, 0, 0}}, {{0, 0, 0}, {1, 0, 0}}, AlignmentMode::kSe3},
      {cube, mirrored, AlignmentMode::kSe3},
      {vertical, vertical, AlignmentMode::kYawOnly},
  };
  for (const auto& [source, target, mode] : cases) {
    EXPECT_EQ(UmeyamaAlignment(source, target, mode).status().code(),
              absl::StatusCode::kInvalidArgument)
        << source.size() << " points, mode " << static_cast<int>(mode);
  }
}

TEST(UmeyamaAlignment, RefusesUnequalLengthsAndNumbersThatAreNone) {
  const Points good = {{1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  EXPECT_FALSE(UmeyamaAlignment(good, {{1, 0, 0}}, AlignmentMode::kSe3).ok());
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Points points = good;
    points[1].y() = bad;
    for (const AlignmentMode mode : {AlignmentMode::kSe3, AlignmentMode::kYawOnly}) {
      EXPECT_FALSE(UmeyamaAlignment(points, points, mode).ok()) << bad;
      EXPECT_FALSE(UmeyamaAlignment(good, {good[0], points[1], {0, 0, bad}}, mode).ok()) << bad;
    }
  }
}

}  // namespace
}  // namespace overtone
