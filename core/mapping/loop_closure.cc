// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/loop_closure.h"

#include <utility>

#include "Eigen/Eigenvalues"
#include "Eigen/LU"
#include "absl/strings/str_cat.h"
#include "absl/strings/str_format.h"

namespace overtone {
namespace {

// A relative pose with one direction open is still worth its five others; a plane leaves three.
constexpr int kMaxOpenDirections = 2;
// m^2: no registration that holds a direction is so unsure of it.
constexpr double kOpenVariance = 100;
constexpr double kOpenRotationVariance = 1e4;  // rad^2: any heading

}  // namespace

const std::vector<ClosureVerdict>& AllClosureVerdicts() {
  static const auto* const verdicts =
      new std::vector<ClosureVerdict>{ClosureVerdict::kPending,
                                      ClosureVerdict::kAccepted,
                                      ClosureVerdict::kDemotedByOptimiser,
                                      ClosureVerdict::kQuarantined,
                                      ClosureVerdict::kRejectedScore,
                                      ClosureVerdict::kRejectedOverlap,
                                      ClosureVerdict::kRejectedResidual,
                                      ClosureVerdict::kRejectedDegenerate,
                                      ClosureVerdict::kRejectedInconsistent,
                                      ClosureVerdict::kVetoedByOperator,
                                      ClosureVerdict::kForcedByOperator};
  return *verdicts;
}

absl::string_view ToString(ClosureVerdict verdict) {
  switch (verdict) {
    case ClosureVerdict::kPending:
      return "pending";
    case ClosureVerdict::kAccepted:
      return "accepted";
    case ClosureVerdict::kDemotedByOptimiser:
      return "demoted_by_optimiser";
    case ClosureVerdict::kQuarantined:
      return "quarantined";
    case ClosureVerdict::kRejectedScore:
      return "rejected_score";
    case ClosureVerdict::kRejectedOverlap:
      return "rejected_overlap";
    case ClosureVerdict::kRejectedResidual:
      return "rejected_residual";
    case ClosureVerdict::kRejectedDegenerate:
      return "rejected_degenerate";
    case ClosureVerdict::kRejectedInconsistent:
      return "rejected_inconsistent";
    case ClosureVerdict::kVetoedByOperator:
      return "vetoed_by_operator";
    case ClosureVerdict::kForcedByOperator:
      return "forced_by_operator";
  }
  return "unknown";
}

Matrix6d InformationOf(const LoopCandidate& candidate) {
  Matrix6d information = candidate.covariance.inverse();
  if (!IsWeak(candidate)) return information;
  const Eigen::SelfAdjointEigenSolver<Matrix6d> axes(candidate.covariance);
  for (int i = 0; i < 6; ++i) {
    if (axes.eigenvalues()[i] < kOpenVariance) continue;
    const Vector6d open = axes.eigenvectors().col(i);
    const Matrix6d closed = Matrix6d::Identity() - open * open.transpose();
    information = closed * information * closed;
  }
  return 0.5 * (information + information.transpose());
}

ClosureVerdict JudgeFigures(const LoopCandidate& candidate) {
  // Written so that NaN fails.
  if (!(candidate.score >= candidate.score_threshold)) return ClosureVerdict::kRejectedScore;
  if (!candidate.registration.has_value()) return ClosureVerdict::kPending;
  const RegistrationFigures& figures = *candidate.registration;
  if (!figures.converged || !(figures.overlap >= figures.overlap_threshold)) {
    return ClosureVerdict::kRejectedOverlap;
  }
  if (!(figures.residual_m <= figures.residual_limit_m)) return ClosureVerdict::kRejectedResidual;
  if (figures.open_directions > kMaxOpenDirections) return ClosureVerdict::kRejectedDegenerate;
  return ClosureVerdict::kPending;
}

std::string Reason(const ClosureRecord& record) {
  const LoopCandidate& candidate = record.candidate;
  const RegistrationFigures figures = candidate.registration.value_or(RegistrationFigures());
  switch (record.verdict) {
    case ClosureVerdict::kPending:
      return candidate.measured ? "waits for a keyframe that is not in the map yet"
                                : "nobody has measured its relative pose yet";
    case ClosureVerdict::kAccepted:
      return absl::StrFormat("fits the map, chi square %.2f", record.chi_square);
    case ClosureVerdict::kDemotedByOptimiser:
      return absl::StrFormat("contradicts the rest of the map, chi square %.4g", record.chi_square);
    case ClosureVerdict::kQuarantined:
      return absl::StrCat("would tie two components that nothing else ties yet, with ",
                          record.consistent_set, " consistent closures in all, too few");
    case ClosureVerdict::kRejectedScore:
      return absl::StrFormat("similarity %.2f is below %.2f", candidate.score,
                             candidate.score_threshold);
    case ClosureVerdict::kRejectedOverlap:
      return figures.converged ? absl::StrFormat("the clouds overlap by %.2f, %.2f are needed",
                                                 figures.overlap, figures.overlap_threshold)
                               : "the registration of the clouds did not converge";
    case ClosureVerdict::kRejectedResidual:
      return absl::StrFormat("the registered clouds lie %.2f m apart, at most %.2f m are taken",
                             figures.residual_m, figures.residual_limit_m);
    case ClosureVerdict::kRejectedDegenerate:
      return absl::StrCat("the clouds leave ", figures.open_directions, " of six directions open, ",
                          figures.open_directions > kMaxOpenDirections
                              ? "too many"
                              : "and the map does not expect the two places to be one");
    case ClosureVerdict::kRejectedInconsistent:
      if (candidate.from.mission == candidate.to.mission) {
        return "further from its mission's odometry than that can have drifted in between";
      }
      return absl::StrCat("disagrees with the ", record.consistent_set,
                          " closures that agree between its two missions");
    case ClosureVerdict::kVetoedByOperator:
      return "an operator has vetoed it";
    case ClosureVerdict::kForcedByOperator:
      return absl::StrFormat("an operator wants it used, chi square %.4g", record.chi_square);
  }
  return "";
}

LoopCandidate CandidateOf(const LoopClosure& closure) {
  LoopCandidate candidate;
  candidate.from = closure.from;
  candidate.to = closure.to;
  candidate.from_tform_to = closure.from_tform_to;
  candidate.covariance = closure.covariance;
  candidate.measured = true;
  return candidate;
}

LoopCandidate WeakCandidateOf(const ScoredCandidate& scored, double score_threshold,
                              double position_sigma_m) {
  LoopCandidate candidate;
  candidate.from = scored.from;
  candidate.to = scored.to;
  candidate.proposer = LoopEvidence::kRobotScore;
  candidate.score = scored.score;
  candidate.score_threshold = score_threshold;
  candidate.covariance.diagonal() << Eigen::Vector3d::Constant(position_sigma_m * position_sigma_m),
      Eigen::Vector3d::Constant(kOpenRotationVariance);
  candidate.measured = true;
  return candidate;
}

// T^-1 = (T_mean Exp(d))^-1 = T_mean^-1 Exp(-Ad(T_mean) d).
LoopCandidate Reversed(const LoopCandidate& candidate) {
  LoopCandidate reversed = candidate;
  std::swap(reversed.from, reversed.to);
  reversed.from_tform_to = candidate.from_tform_to.Inverse();
  const Matrix6d adjoint = Adjoint(candidate.from_tform_to);
  reversed.covariance = adjoint * candidate.covariance * adjoint.transpose();
  return reversed;
}

bool RotationIsOpen(const Matrix6d& covariance) {
  return covariance.diagonal().tail<3>().maxCoeff() > 1;
}

}  // namespace overtone
