// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/estimation/graduated_non_convexity.h"

#include <algorithm>

namespace overtone {
namespace {

// Solves between two weight updates need not be exact: the next one goes on from there.
constexpr int kInnerSteps = 1;
// Enough for a set of measurements that fits; one that does not is left to the schedule.
constexpr int kProbeSteps = 5;
// Truncation: with this mu only residuals within 6 % of the limit have a weight between 0 and 1.
constexpr double kSharpMu = 16;
// Updates of the final 0/1 weights; more than a few mean that a measurement sits on the limit
// and flips.
constexpr int kMaxSettlingSteps = 5;

// Of chi squares in units of their limits.
constexpr double kLimit = 1;

class GncRun {
 public:
  GncRun(const std::vector<int>& doubtful, const GncOptions& options, const SolveLimits& limits,
         PoseGraphProblem& problem)
      : doubtful_(doubtful), options_(options), limits_(limits), problem_(problem) {}

  SolveSummary Run(const std::vector<double>& initial_weights) {
    const PoseGraphEstimate initial = problem_.Estimate();
    SetWeights(initial_weights);
    SolveLimits probe = limits_;
    probe.max_steps = kProbeSteps;
    Solve(probe);
    const double initial_cost = last_.initial_cost;
    if (last_.given_up) return last_;
    if (weights_ != ThresholdWeights()) {
      problem_.SetEstimate(initial);
      problem_.PlaceLandmarks();
      RunSchedule();
    } else if (!last_.converged) {
      Settle();
    }
    last_.initial_cost = initial_cost;
    last_.iterations = iterations_;
    return last_;
  }

 private:
  // From the initial estimate, not from the least-squares solution with everything in use: a few
  // gross errors turn that one inside out, and it is not convex on rotations. At first the
  // surrogate makes the doubtful soft against the odometry, the wrong softest. Landmarks begin in
  // the middle of their sightings: a landmark given where one wrong sighting put it would stay
  // there, since that one fits and the right ones do not.
  void RunSchedule() {
    SolveLimits inner = limits_;
    inner.max_steps = kInnerSteps;
    double mu = InitialControlParameter(options_.loss, LargestRatio(), kLimit);
    for (int step = 0; step < options_.max_steps; ++step) {
      SetWeights(SurrogateWeights(mu));
      Solve(inner);
      if (last_.given_up) return;
      const double next_mu = NextControlParameter(options_.loss, mu, options_.factor);
      if (next_mu == mu || IsSharp(mu) || (step > 0 && WeightsAreBinary())) break;
      mu = next_mu;
    }
    Settle();
  }

  // Ends on a stationary point of the loss itself.
  void Settle() {
    if (options_.loss == RobustLoss::kGemanMcClure) return Solve(limits_);
    for (int step = 0; step < kMaxSettlingSteps; ++step) {
      SetWeights(ThresholdWeights());
      Solve(limits_);
      if (last_.given_up || weights_ == ThresholdWeights()) return;
    }
  }

  void Solve(const SolveLimits& limits) {
    last_ = problem_.Solve(limits);
    iterations_ += last_.iterations;
  }

  void SetWeights(const std::vector<double>& weights) {
    for (size_t k = 0; k < doubtful_.size(); ++k) problem_.SetWeight(doubtful_[k], weights[k]);
    weights_ = weights;
  }

  // 1 within the limit, 0 beyond.
  std::vector<double> ThresholdWeights() const {
    std::vector<double> weights(doubtful_.size());
    for (size_t k = 0; k < doubtful_.size(); ++k) {
      weights[k] = problem_.ChiSquareOverLimit(doubtful_[k]) <= kLimit ? 1 : 0;
    }
    return weights;
  }

  std::vector<double> SurrogateWeights(double mu) const {
    std::vector<double> weights(doubtful_.size());
    for (size_t k = 0; k < doubtful_.size(); ++k) {
      weights[k] =
          SurrogateWeight(options_.loss, problem_.ChiSquareOverLimit(doubtful_[k]), kLimit, mu);
    }
    return weights;
  }

  // Of the measurements in use. Those that an earlier run left out may be far worse, and would make
  // the schedule begin by loosening a map that is tight already.
  double LargestRatio() const {
    double largest = 0;
    for (size_t k = 0; k < doubtful_.size(); ++k) {
      if (weights_[k] > 0) largest = std::max(largest, problem_.ChiSquareOverLimit(doubtful_[k]));
    }
    return largest;
  }

  bool IsSharp(double mu) const {
    return options_.loss == RobustLoss::kTruncatedLeastSquares && mu >= kSharpMu;
  }

  bool WeightsAreBinary() const {
    return std::all_of(weights_.begin(), weights_.end(), [](double w) { return w == 0 || w == 1; });
  }

  const std::vector<int>& doubtful_;
  const GncOptions& options_;
  const SolveLimits& limits_;
  PoseGraphProblem& problem_;
  std::vector<double> weights_;
  SolveSummary last_;
  int iterations_ = 0;
};

}  // namespace

SolveSummary SolveGraduated(const std::vector<int>& doubtful,
                            const std::vector<double>& initial_weights, const GncOptions& options,
                            const SolveLimits& limits, PoseGraphProblem& problem) {
  return GncRun(doubtful, options, limits, problem).Run(initial_weights);
}

}  // namespace overtone
