// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/loop_closure.h"

#include <cmath>
#include <limits>
#include <set>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/core/mapping/map_test_support.h"

namespace overtone {
namespace {

const double kNan = std::nan("");

// Everything in order, everything at its limit.
LoopCandidate Passing() {
  LoopCandidate candidate;
  candidate.proposer = LoopEvidence::kScanContext;
  candidate.score = candidate.score_threshold = 0.6;
  candidate.measured = true;
  candidate.registration =
      RegistrationFigures{/*converged=*/true,        /*overlap=*/0.7,
                          /*overlap_threshold=*/0.7, /*residual_m=*/0.1,
                          /*residual_limit_m=*/0.1,  /*open_directions=*/2};
  return candidate;
}

TEST(JudgeFigures, TakesWhatJustMeetsEveryLimit) {
  EXPECT_EQ(JudgeFigures(Passing()), ClosureVerdict::kPending);
}

TEST(JudgeFigures, RefusesWhatJustMissesALimit) {
  const auto verdict = [](auto spoil) {
    LoopCandidate candidate = Passing();
    spoil(candidate, *candidate.registration);
    return JudgeFigures(candidate);
  };
  EXPECT_EQ(verdict([](auto& c, auto&) { c.score = 0.59; }), ClosureVerdict::kRejectedScore);
  EXPECT_EQ(verdict([](auto&, auto& f) { f.overlap = 0.69; }), ClosureVerdict::kRejectedOverlap);
  EXPECT_EQ(verdict([](auto&, auto& f) { f.converged = false; }), ClosureVerdict::kRejectedOverlap);
  EXPECT_EQ(verdict([](auto&, auto& f) { f.residual_m = 0.11; }),
            ClosureVerdict::kRejectedResidual);
  EXPECT_EQ(verdict([](auto&, auto& f) { f.open_directions = 3; }),
            ClosureVerdict::kRejectedDegenerate);
}

TEST(JudgeFigures, RefusesWhatIsNoNumber) {
  LoopCandidate candidate = Passing();
  candidate.registration->residual_m = kNan;
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kRejectedResidual);
  candidate.registration->residual_m = std::numeric_limits<double>::infinity();
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kRejectedResidual);
  candidate.registration->overlap = kNan;
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kRejectedOverlap);
  candidate.score = kNan;
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kRejectedScore);
}

// All spoilt; then mended in the order of the checks.
TEST(JudgeFigures, NamesTheCheapestCheckThatFails) {
  LoopCandidate candidate = Passing();
  candidate.score = 0;
  candidate.registration = RegistrationFigures{true, 0, 0.7, 1, 0.1, 6};
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kRejectedScore);
  candidate.score = 1;
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kRejectedOverlap);
  candidate.registration->overlap = 1;
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kRejectedResidual);
  candidate.registration->residual_m = 0;
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kRejectedDegenerate);
  candidate.registration->open_directions = 0;
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kPending);
}

TEST(JudgeFigures, WithoutRegistrationOnlyTheScoreCounts) {
  LoopCandidate candidate = Passing();
  candidate.registration.reset();
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kPending);
  candidate.score = 0.5;
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kRejectedScore);
}

TEST(ClosureVerdict, EachHasANameOfItsOwn) {
  std::vector<std::string> names;
  for (const ClosureVerdict verdict : AllClosureVerdicts()) names.emplace_back(ToString(verdict));
  EXPECT_THAT(names,
              testing::ElementsAre("pending", "accepted", "demoted_by_optimiser", "quarantined",
                                   "rejected_score", "rejected_overlap", "rejected_residual",
                                   "rejected_degenerate", "rejected_inconsistent",
                                   "vetoed_by_operator", "forced_by_operator"));
  EXPECT_EQ(ToString(static_cast<ClosureVerdict>(99)), "unknown");
}

TEST(ClosureVerdict, OnlyAcceptedAndForcedOnesAreInUse) {
  std::set<ClosureVerdict> in_use;
  for (const ClosureVerdict verdict : AllClosureVerdicts()) {
    if (InUse(verdict)) in_use.insert(verdict);
  }
  EXPECT_THAT(in_use,
              testing::ElementsAre(ClosureVerdict::kAccepted, ClosureVerdict::kForcedByOperator));
}

TEST(Reason, SaysTheFiguresThatDecided) {
  ClosureRecord record;
  record.candidate.from.mission = {"a", "m0"};
  record.candidate.to.mission = {"b", "m0"};
  record.candidate.score = 0.456;
  record.candidate.score_threshold = 0.6;
  record.candidate.measured = true;
  record.candidate.registration = RegistrationFigures{true, 0.312, 0.7, 0.256, 0.15, 4};
  record.chi_square = 1234.567;
  record.consistent_set = 2;
  const auto reason = [&](ClosureVerdict verdict) {
    record.verdict = verdict;
    return Reason(record);
  };
  EXPECT_EQ(reason(ClosureVerdict::kPending), "waits for a keyframe that is not in the map yet");
  EXPECT_EQ(reason(ClosureVerdict::kAccepted), "fits the map, chi square 1234.57");
  EXPECT_EQ(reason(ClosureVerdict::kDemotedByOptimiser),
            "contradicts the rest of the map, chi square 1235");
  EXPECT_EQ(reason(ClosureVerdict::kQuarantined),
            "would tie two components that nothing else ties yet, with 2 consistent closures in "
            "all, too few");
  EXPECT_EQ(reason(ClosureVerdict::kRejectedScore), "similarity 0.46 is below 0.60");
  EXPECT_EQ(reason(ClosureVerdict::kRejectedOverlap),
            "the clouds overlap by 0.31, 0.70 are needed");
  EXPECT_EQ(reason(ClosureVerdict::kRejectedResidual),
            "the registered clouds lie 0.26 m apart, at most 0.15 m are taken");
  EXPECT_EQ(reason(ClosureVerdict::kRejectedDegenerate),
            "the clouds leave 4 of six directions open, too many");
  EXPECT_EQ(reason(ClosureVerdict::kRejectedInconsistent),
            "disagrees with the 2 closures that agree between its two missions");
  record.candidate.to.mission = record.candidate.from.mission;
  EXPECT_EQ(reason(ClosureVerdict::kRejectedInconsistent),
            "further from its mission's odometry than that can have drifted in between");
  record.candidate.registration->open_directions = 1;
  EXPECT_EQ(reason(ClosureVerdict::kRejectedDegenerate),
            "the clouds leave 1 of six directions open, and the map does not expect the two places "
            "to be one");
  EXPECT_EQ(reason(ClosureVerdict::kVetoedByOperator), "an operator has vetoed it");
  EXPECT_EQ(reason(ClosureVerdict::kForcedByOperator),
            "an operator wants it used, chi square 1235");
  record.candidate.measured = false;
  EXPECT_EQ(reason(ClosureVerdict::kPending), "nobody has measured its relative pose yet");
  record.candidate.registration->converged = false;
  EXPECT_EQ(reason(ClosureVerdict::kRejectedOverlap),
            "the registration of the clouds did not converge");
}

TEST(CandidateOf, CarriesTheRobotsMeasurementAndPasses) {
  const Matrix6d covariance = Covariance(0.3, 0.1);
  const LoopClosure closure =
      MakeClosure({Mission("a"), 7}, {Mission("b"), 2}, Planar(1, 2, 0.5), covariance);
  const LoopCandidate candidate = CandidateOf(closure);
  EXPECT_EQ(candidate.from, closure.from);
  EXPECT_EQ(candidate.to, closure.to);
  EXPECT_EQ(candidate.from_tform_to.ToMatrix(), closure.from_tform_to.ToMatrix());
  EXPECT_EQ(candidate.covariance, covariance);
  EXPECT_EQ(candidate.proposer, LoopEvidence::kRobot);
  EXPECT_TRUE(candidate.measured);
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kPending);
}

TEST(WeakCandidateOf, IsTheSamePlaceWithinTheSigmaAndAnyHeading) {
  const ScoredCandidate scored = {{Mission("a"), 7}, {Mission("b"), 2}, 0.6};
  const LoopCandidate candidate = WeakCandidateOf(scored, /*score_threshold=*/0.5, 2);
  EXPECT_EQ(candidate.from, scored.from);
  EXPECT_EQ(candidate.to, scored.to);
  EXPECT_EQ(candidate.proposer, LoopEvidence::kRobotScore);
  EXPECT_TRUE(candidate.measured);
  EXPECT_EQ(candidate.from_tform_to.translation, Eigen::Vector3d::Zero());
  const Matrix6d& covariance = candidate.covariance;
  EXPECT_TRUE(covariance.isDiagonal());
  EXPECT_EQ(covariance.diagonal().head<3>(), Eigen::Vector3d::Constant(4));
  EXPECT_GT(covariance.diagonal().tail<3>().minCoeff(), M_PI * M_PI);
  EXPECT_TRUE(RotationIsOpen(covariance));
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kPending);
  EXPECT_EQ(JudgeFigures(WeakCandidateOf(scored, 0.61, 2)), ClosureVerdict::kRejectedScore);
}

TEST(RotationIsOpen, LooksAtEveryAxisAndNotAtTheTranslation) {
  EXPECT_FALSE(RotationIsOpen(Covariance(100, 0.9)));
  for (const int axis : {3, 4, 5}) {
    Matrix6d covariance = Covariance(0.1, 0.01);
    covariance(axis, axis) = 1.1;
    EXPECT_TRUE(RotationIsOpen(covariance)) << axis;
  }
}

}  // namespace
}  // namespace overtone
