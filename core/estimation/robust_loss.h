// SPDX-License-Identifier: Apache-2.0
// How much a measurement may pull when it disagrees with the rest. s = |r|^2 is its weighted
// squared residual (chi square), c^2 the limit above which it counts as an outlier.
#ifndef OVERTONE_CORE_ESTIMATION_ROBUST_LOSS_H_
#define OVERTONE_CORE_ESTIMATION_ROBUST_LOSS_H_

#include <memory>

#include "ceres/loss_function.h"

namespace overtone {

enum class RobustLoss {
  kNone,                   // s
  kHuber,                  // s up to c^2, 2 c sqrt(s) - c^2 above
  kCauchy,                 // c^2 log(1 + s / c^2)
  kTruncatedLeastSquares,  // min(s, c^2), by graduated non-convexity
  kGemanMcClure,           // c^2 s / (c^2 + s), by graduated non-convexity
};

// True for the losses that are minimised through a sequence of surrogates
// (graduated_non_convexity.h).
bool IsGraduated(RobustLoss loss);

// The loss as Ceres sees it; nullptr for kNone and for graduated losses, which work through
// weights.
std::unique_ptr<ceres::LossFunction> MakeLossFunction(RobustLoss loss, double squared_limit);

// The derivative of the loss at s: the weight a measurement has in iteratively reweighted least
// squares. (0, 1].
double InfluenceWeight(const ceres::LossFunction& loss, double chi_square);

// Surrogates of Yang, Antonante, Tzoumas & Carlone, "Graduated Non-Convexity for Robust Spatial
// Perception", RA-L 5(2), 2020. Their convexity is governed by mu, which starts where the surrogate
// is convex for every residual up to `largest_chi_square` (remarks 5) and moves towards the loss
// itself.
double InitialControlParameter(RobustLoss loss, double largest_chi_square, double squared_limit);
double NextControlParameter(RobustLoss loss, double mu, double factor);
// Equations (12) and (14). [0, 1].
double SurrogateWeight(RobustLoss loss, double chi_square, double squared_limit, double mu);

}  // namespace overtone

#endif  // OVERTONE_CORE_ESTIMATION_ROBUST_LOSS_H_
