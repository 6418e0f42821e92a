// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/robust_loss.h"

#include <algorithm>
#include <cmath>

namespace overtone {
namespace {

// Below it Geman-McClure's surrogate is the loss itself.
constexpr double kGemanMcClureFinalMu = 1;
// Keeps the truncated surrogate defined when every residual is already small.
constexpr double kSmallestMu = 1e-9;

}  // namespace

bool IsGraduated(RobustLoss loss) {
  return loss == RobustLoss::kTruncatedLeastSquares || loss == RobustLoss::kGemanMcClure;
}

std::unique_ptr<ceres::LossFunction> MakeLossFunction(RobustLoss loss, double squared_limit) {
  const double limit = std::sqrt(squared_limit);
  switch (loss) {
    case RobustLoss::kHuber:
      return std::make_unique<ceres::HuberLoss>(limit);
    case RobustLoss::kCauchy:
      return std::make_unique<ceres::CauchyLoss>(limit);
    case RobustLoss::kNone:
    case RobustLoss::kTruncatedLeastSquares:
    case RobustLoss::kGemanMcClure:
      break;
  }
  return nullptr;
}

double InfluenceWeight(const ceres::LossFunction& loss, double chi_square) {
  double value_and_derivatives[3];
  loss.Evaluate(chi_square, value_and_derivatives);
  return value_and_derivatives[1];
}

double InitialControlParameter(RobustLoss loss, double largest_chi_square, double squared_limit) {
  if (loss == RobustLoss::kGemanMcClure) {
    return std::max(kGemanMcClureFinalMu, 2 * largest_chi_square / squared_limit);
  }
  const double excess = 2 * largest_chi_square - squared_limit;
  // excess <= 0: every residual is within the limit and any mu leaves it at full weight.
  return excess > 0 ? std::max(kSmallestMu, squared_limit / excess) : 1 / kSmallestMu;
}

double NextControlParameter(RobustLoss loss, double mu, double factor) {
  if (loss == RobustLoss::kGemanMcClure) return std::max(kGemanMcClureFinalMu, mu / factor);
  return mu * factor;
}

double SurrogateWeight(RobustLoss loss, double chi_square, double squared_limit, double mu) {
  if (loss == RobustLoss::kGemanMcClure) {
    const double ratio = mu * squared_limit / (chi_square + mu * squared_limit);
    return ratio * ratio;
  }
  if (chi_square <= mu / (mu + 1) * squared_limit) return 1;
  if (chi_square >= (mu + 1) / mu * squared_limit) return 0;
  return std::sqrt(squared_limit * mu * (mu + 1) / chi_square) - mu;
}

}  // namespace overtone
