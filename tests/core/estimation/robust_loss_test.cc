// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/robust_loss.h"

#include <cmath>

#include "gtest/gtest.h"

namespace overtone {
namespace {

constexpr double kLimit = 9;

TEST(RobustLoss, HuberAndCauchyAreQuadraticInside) {
  for (const RobustLoss loss : {RobustLoss::kHuber, RobustLoss::kCauchy}) {
    EXPECT_NEAR(InfluenceWeight(*MakeLossFunction(loss, kLimit), 1e-9), 1, 1e-6);
  }
}

TEST(RobustLoss, HuberPullsWithConstantForceOutside) {
  // Weight = c / |r|.
  EXPECT_NEAR(InfluenceWeight(*MakeLossFunction(RobustLoss::kHuber, kLimit), 36), 3.0 / 6.0, 1e-12);
}

TEST(RobustLoss, CauchyHalvesTheWeightAtItsLimit) {
  EXPECT_NEAR(InfluenceWeight(*MakeLossFunction(RobustLoss::kCauchy, kLimit), kLimit), 0.5, 1e-12);
}

TEST(RobustLoss, GraduatedLossesWorkThroughWeightsAlone) {
  EXPECT_TRUE(IsGraduated(RobustLoss::kTruncatedLeastSquares));
  EXPECT_TRUE(IsGraduated(RobustLoss::kGemanMcClure));
  EXPECT_EQ(MakeLossFunction(RobustLoss::kTruncatedLeastSquares, kLimit), nullptr);
  EXPECT_FALSE(IsGraduated(RobustLoss::kHuber));
}

TEST(RobustLoss, TruncatedWeightIsContinuousAndFallsFromOneToZero) {
  const double mu = 0.3;
  const double inner = mu / (mu + 1) * kLimit, outer = (mu + 1) / mu * kLimit;
  const auto weight = [&](double s) {
    return SurrogateWeight(RobustLoss::kTruncatedLeastSquares, s, kLimit, mu);
  };
  EXPECT_EQ(weight(0.99 * inner), 1);
  EXPECT_NEAR(weight(inner * (1 + 1e-9)), 1, 1e-6);
  EXPECT_NEAR(weight(outer * (1 - 1e-9)), 0, 1e-6);
  EXPECT_EQ(weight(1.01 * outer), 0);
  EXPECT_GT(weight(kLimit), weight(1.5 * kLimit));
}

TEST(RobustLoss, TruncatedWeightBecomesAThresholdAtTheLimit) {
  const auto weight = [&](double s) {
    return SurrogateWeight(RobustLoss::kTruncatedLeastSquares, s, kLimit, 1e6);
  };
  EXPECT_EQ(weight(0.999 * kLimit), 1);
  EXPECT_EQ(weight(1.001 * kLimit), 0);
}

// The weight is the derivative of the surrogate loss c^2 s mu / (mu c^2 + s) by s.
TEST(RobustLoss, GemanMcClureWeightIsTheSurrogatesDerivative) {
  const double mu = 3, s = 5, h = 1e-6;
  const auto surrogate = [&](double x) { return mu * kLimit * x / (mu * kLimit + x); };
  EXPECT_NEAR(SurrogateWeight(RobustLoss::kGemanMcClure, s, kLimit, mu),
              (surrogate(s + h) - surrogate(s - h)) / (2 * h), 1e-8);
}

TEST(RobustLoss, TheScheduleStartsConvexAndMovesTowardsTheLoss) {
  const double largest = 1e4;
  const double tls = InitialControlParameter(RobustLoss::kTruncatedLeastSquares, largest, kLimit);
  EXPECT_NEAR(tls, kLimit / (2 * largest - kLimit), 1e-12);
  EXPECT_GT(SurrogateWeight(RobustLoss::kTruncatedLeastSquares, largest, kLimit, tls), 0);
  EXPECT_GT(NextControlParameter(RobustLoss::kTruncatedLeastSquares, tls, 1.4), tls);
  const double gm = InitialControlParameter(RobustLoss::kGemanMcClure, largest, kLimit);
  EXPECT_NEAR(gm, 2 * largest / kLimit, 1e-9);
  EXPECT_LT(NextControlParameter(RobustLoss::kGemanMcClure, gm, 1.4), gm);
  EXPECT_EQ(NextControlParameter(RobustLoss::kGemanMcClure, 1.0, 1.4), 1.0);
}

TEST(RobustLoss, ResidualsWithinTheLimitKeepFullWeightFromTheStart) {
  const double mu =
      InitialControlParameter(RobustLoss::kTruncatedLeastSquares, 0.4 * kLimit, kLimit);
  EXPECT_EQ(SurrogateWeight(RobustLoss::kTruncatedLeastSquares, 0.4 * kLimit, kLimit, mu), 1);
}

}  // namespace
}  // namespace overtone
