// SPDX-License-Identifier: Apache-2.0
// An operator's word on closures, and the way back to an earlier revision.
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/mapping/multi_robot_map.h"
#include "overtone/tests/core/mapping/map_test_support.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

// One robot around a circle, closed at its end by a right closure, and a wrong one that the
// robust back end is kept from noticing.
class DecisionsTest : public ::testing::Test {
 protected:
  DecisionsTest() : map_(Options()) {
    std::mt19937 random(3);
    odometry_ = Drifted(truth_, Rigid3d(), Covariance(0.02, 0.004), random);
    EXPECT_TRUE(
        map_.AddSubmap(Mission("a"), MakeSubmap(0, 0, odometry_, Covariance(0.02, 0.004))).ok());
    EXPECT_TRUE(map_.AddLoopClosure(MakeClosure({Mission("a"), 59}, {Mission("a"), 0},
                                                truth_[59].Inverse() * truth_[0]))
                    .ok());
    good_ = map_.Optimise();
    EXPECT_TRUE(
        map_.AddLoopClosure(MakeClosure({Mission("a"), 30}, {Mission("a"), 0}, Planar(1, 0, 0)))
            .ok());
    bad_ = map_.Optimise();
  }

  static MultiRobotMapOptions Options() {
    MultiRobotMapOptions options;
    options.robust = MultiRobotMapOptions::Robust::kNone;
    return options;
  }

  static double Distance(const MapSnapshot& a, const MapSnapshot& b) {
    double largest = 0;
    for (size_t i = 0; i < a.missions[0].map_from_body.size(); ++i) {
      largest = std::max(largest, (a.missions[0].map_from_body[i].translation -
                                   b.missions[0].map_from_body[i].translation)
                                      .norm());
    }
    return largest;
  }

  const std::vector<Rigid3d> truth_ = CirclePoses(60);
  std::vector<Rigid3d> odometry_;
  MultiRobotMap map_;
  std::shared_ptr<const MapSnapshot> good_, bad_;
};

TEST_F(DecisionsTest, AVetoedClosureLeavesNoTraceInTheMap) {
  ASSERT_GT(Distance(*good_, *bad_), 1);
  ASSERT_TRUE(map_.Veto("a/m0:30>a/m0:0#0").ok());
  EXPECT_TRUE(map_.dirty());
  const auto snapshot = map_.Optimise();
  EXPECT_EQ(ToString(snapshot->closures[1].verdict), "vetoed_by_operator");
  EXPECT_EQ(snapshot->closures[1].weight, 0);
  EXPECT_EQ(ToString(snapshot->closures[0].verdict), "accepted");
  EXPECT_LT(Distance(*good_, *snapshot), 1e-3);
  EXPECT_EQ(snapshot->map_epoch, good_->map_epoch);
  EXPECT_THAT(map_.history().records().back().dropped, testing::ElementsAre("a/m0:30>a/m0:0#0"));
}

TEST_F(DecisionsTest, AForcedClosureIsUsedWhateverItsFigures) {
  LoopCandidate candidate = CandidateOf(
      MakeClosure({Mission("a"), 20}, {Mission("a"), 0}, truth_[20].Inverse() * truth_[0]));
  candidate.proposer = LoopEvidence::kScanContext;
  candidate.registration = RegistrationFigures{true, 0.2, 0.6, 0.05, 0.1, 0};
  ASSERT_TRUE(map_.AddCandidate(candidate).ok());
  auto snapshot = map_.Optimise();
  EXPECT_EQ(ToString(snapshot->closures[2].verdict), "rejected_overlap");
  EXPECT_EQ(Reason(snapshot->closures[2]), "the clouds overlap by 0.20, 0.60 are needed");
  ASSERT_TRUE(map_.Force("a/m0:20>a/m0:0#0").ok());
  snapshot = map_.Optimise();
  EXPECT_EQ(ToString(snapshot->closures[2].verdict), "forced_by_operator");
  EXPECT_EQ(snapshot->closures[2].weight, 1);
  ASSERT_TRUE(map_.Veto("a/m0:20>a/m0:0#0").ok());
  EXPECT_EQ(ToString(map_.Optimise()->closures[2].verdict), "vetoed_by_operator");
}

// Hundreds of pairs along a bare corridor, each within 100 m, would pull it together.
TEST_F(DecisionsTest, AMeasurementWithADirectionOpenIsNotUsed) {
  LoopCandidate candidate = CandidateOf(
      MakeClosure({Mission("a"), 20}, {Mission("a"), 0}, truth_[20].Inverse() * truth_[0]));
  candidate.proposer = LoopEvidence::kScanContext;
  candidate.registration = RegistrationFigures{true, 0.9, 0.6, 0.05, 0.1, 1};
  ASSERT_TRUE(map_.AddCandidate(candidate).ok());
  const auto snapshot = map_.Optimise();
  EXPECT_EQ(ToString(snapshot->closures[2].verdict), "rejected_degenerate");
  EXPECT_EQ(Reason(snapshot->closures[2]), "the clouds leave 1 of six directions open");
}

TEST_F(DecisionsTest, RollingBackUndoesWhatCameAfterAndStartsANewEpoch) {
  ASSERT_TRUE(map_.AddSubmap(Mission("b"), MakeSubmap(0, 0, CirclePoses(5))).ok());
  map_.Optimise();
  const auto vetoed = map_.RollBack(good_->revision, 77);
  ASSERT_TRUE(vetoed.ok()) << vetoed.status();
  EXPECT_EQ(*vetoed, 1);
  const auto snapshot = map_.Optimise();
  EXPECT_EQ(snapshot->map_epoch, 77);
  EXPECT_EQ(snapshot->missions.size(), 2);  // submaps stay
  EXPECT_EQ(ToString(snapshot->closures[1].verdict), "vetoed_by_operator");
  EXPECT_LT(Distance(*good_, *snapshot), 1e-3);
  // Revisions of the old epoch are no way back any more.
  EXPECT_EQ(map_.RollBack(good_->revision, 78).status().code(), absl::StatusCode::kNotFound);
}

TEST_F(DecisionsTest, RollingBackBeforeAVetoLiftsIt) {
  ASSERT_TRUE(map_.Veto("a/m0:59>a/m0:0#0").ok());
  EXPECT_EQ(ToString(map_.Optimise()->closures[0].verdict), "vetoed_by_operator");
  ASSERT_TRUE(map_.RollBack(good_->revision, 77).ok());
  const auto snapshot = map_.Optimise();
  EXPECT_EQ(ToString(snapshot->closures[0].verdict), "accepted");
  EXPECT_EQ(ToString(snapshot->closures[1].verdict), "vetoed_by_operator");
  EXPECT_LT(Distance(*good_, *snapshot), 1e-3);
}

TEST_F(DecisionsTest, AWordOnNothingIsRefused) {
  EXPECT_EQ(map_.Veto("a/m0:1>a/m0:0#0").code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(map_.Force("").code(), absl::StatusCode::kNotFound);
  EXPECT_FALSE(map_.dirty());
  LoopCandidate guess;
  guess.from = {Mission("a"), 3};
  guess.to = {Mission("a"), 40};
  ASSERT_TRUE(map_.AddCandidate(guess).ok());
  const absl::Status status = map_.Force("a/m0:3>a/m0:40#0");
  EXPECT_EQ(status.code(), absl::StatusCode::kFailedPrecondition);
  EXPECT_THAT(std::string(status.message()), HasSubstr("no relative pose"));
}

}  // namespace
}  // namespace overtone
