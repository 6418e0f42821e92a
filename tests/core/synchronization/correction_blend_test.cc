// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/correction_blend.h"

#include <limits>

#include "gtest/gtest.h"

namespace overtone {
namespace {

constexpr BlendLimits kLimits = {0.1, 0.2};

Timestamp At(double seconds) { return {static_cast<int64_t>(seconds * 1e9) + 1'000'000'000'000}; }

double Turned(const Rigid3d& a, const Rigid3d& b) {
  return LogSO3(a.rotation.conjugate() * b.rotation).norm();
}

// A drive on a circle far from the origin, and a correction of 0.5 m and 0.15 rad at 10 s.
Rigid3d Driven(double seconds) {
  return Rigid3d(ExpSO3({0, 0, 0.4 * seconds}), Eigen::Vector3d(500 + 2 * std::cos(0.4 * seconds),
                                                                2 * std::sin(0.4 * seconds), 1));
}

const Rigid3d& Correction() {
  static const auto* const correction =
      new Rigid3d(ExpSO3({0, 0.05, 0.15}), Eigen::Vector3d(0.3, -0.4, 0));
  return *correction;
}

Rigid3d Estimate(double seconds) {
  const Rigid3d driven = Driven(seconds);
  if (seconds < 10) return driven;
  return Rigid3d(Correction().rotation * driven.rotation,
                 driven.translation + Correction().translation);
}

TEST(BlendSeconds, TheSlowerOfMovingAndTurningDecides) {
  const Rigid3d moved(Eigen::Quaterniond::Identity(), Eigen::Vector3d(0, 0.5, 0));
  const Rigid3d turned(ExpSO3({0, 0.3, 0}), Eigen::Vector3d(0, 0.1, 0));
  EXPECT_NEAR(BlendSeconds(Rigid3d(), moved, kLimits), 5, 1e-12);
  EXPECT_NEAR(BlendSeconds(Rigid3d(), turned, kLimits), 1.5, 1e-12);
  EXPECT_EQ(BlendSeconds(moved, moved, kLimits), 0);
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(BlendSeconds(Rigid3d(), turned, {kInfinity, kInfinity}), 0);
}

TEST(BlendLimits, MustBePositive) {
  EXPECT_TRUE(BlendLimits().Validate().ok());
  EXPECT_FALSE((BlendLimits{0, 1}).Validate().ok());
  EXPECT_FALSE((BlendLimits{1, std::numeric_limits<double>::quiet_NaN()}).Validate().ok());
}

TEST(CorrectionBlender, ShowsTheEstimateItselfBeforeAndAfter) {
  CorrectionBlender blender(kLimits);
  EXPECT_EQ(blender.Blend(Driven(3), At(3)).translation, Driven(3).translation);
  blender.Corrected(Driven(10), Estimate(10), At(10));
  const Rigid3d at_once = blender.Blend(Estimate(10), At(10));
  EXPECT_LT((at_once.translation - Driven(10).translation).norm(), 1e-9);
  EXPECT_LT(Turned(at_once, Driven(10)), 1e-9);
  const Rigid3d halfway = blender.Blend(Estimate(12.5), At(12.5));
  EXPECT_LT(
      (halfway.translation - Driven(12.5).translation - 0.5 * Correction().translation).norm(),
      1e-9);
  EXPECT_NEAR(Turned(halfway, Driven(12.5)), 0.5 * Turned(Rigid3d(), Correction()), 1e-9);
  EXPECT_EQ(blender.Blend(Estimate(15.1), At(15.1)).translation, Estimate(15.1).translation);
}

TEST(CorrectionBlender, NeverMovesThePoseFasterThanTheLimitsOnTopOfItsMotion) {
  CorrectionBlender blender(kLimits);
  constexpr double kStep_s = 0.05;
  Rigid3d shown = Driven(9);
  bool corrected = false;
  for (double t = 9 + kStep_s; t < 18; t += kStep_s) {
    if (t >= 10 && !corrected) {
      blender.Corrected(Driven(t), Estimate(t), At(t));
      corrected = true;
    }
    const Rigid3d next = blender.Blend(Estimate(t), At(t));
    const Eigen::Vector3d own = Driven(t).translation - Driven(t - kStep_s).translation;
    EXPECT_LE((next.translation - shown.translation - own).norm(), 0.1 * kStep_s + 1e-6) << t;
    EXPECT_LE(Turned(shown, next), (0.4 + 0.2) * kStep_s + 1e-6) << t;
    shown = next;
  }
  EXPECT_LT((shown.translation - Estimate(18).translation).norm(), 0.1);
}

TEST(CorrectionBlender, ASecondCorrectionGoesOnFromWhereTheFirstHasCome) {
  CorrectionBlender blender(kLimits);
  const Rigid3d first(Eigen::Quaterniond::Identity(), Eigen::Vector3d(1, 0, 0));
  const Rigid3d second(Eigen::Quaterniond::Identity(), Eigen::Vector3d(1, 1, 0));
  blender.Corrected(Rigid3d(), first, At(0));
  const Rigid3d shown = blender.Blend(first, At(4));
  EXPECT_NEAR(shown.translation.x(), 0.4, 1e-9);
  blender.Corrected(first, second, At(4));
  EXPECT_LT((blender.Blend(second, At(4)).translation - shown.translation).norm(), 1e-9);
  const double seconds = Eigen::Vector3d(0.6, 1, 0).norm() / 0.1;
  EXPECT_GT((blender.Blend(second, At(4 + 0.99 * seconds)).translation - second.translation).norm(),
            1e-3);
  EXPECT_EQ(blender.Blend(second, At(4 + 1.01 * seconds)).translation, second.translation);
}

TEST(CorrectionBlender, AClockThatStepsBackShowsWhatItShowedAtFirst) {
  CorrectionBlender blender(kLimits);
  blender.Corrected(Driven(10), Estimate(10), At(10));
  EXPECT_LT((blender.Blend(Estimate(10), At(2)).translation - Driven(10).translation).norm(), 1e-9);
}

}  // namespace
}  // namespace overtone
