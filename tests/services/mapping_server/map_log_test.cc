// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/map_log.h"

#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

const MissionId kAnna = {"anna", "run"}, kBert = {"bert", "run"};

LoopCandidate Measured() {
  LoopCandidate candidate;
  candidate.from = {kAnna, 3};
  candidate.to = {kBert, 8};
  candidate.proposer = LoopEvidence::kScanContext;
  candidate.score = 0.8;
  candidate.score_threshold = 0.6;
  candidate.from_tform_to = Exp((Vector6d() << 1, -2, 0.3, 0.1, 0.2, -3).finished());
  candidate.covariance = 1e-3 * Matrix6d::Identity();
  candidate.covariance(0, 4) = candidate.covariance(4, 0) = 1e-4;
  candidate.covariance(2, 2) = 1e15;  // an open direction, beyond what a robot may send
  candidate.measured = true;
  candidate.registration = RegistrationFigures{true, 0.7, 0.4, 0.05, 0.2, 1};
  return candidate;
}

void ExpectSame(const LoopCandidate& a, const LoopCandidate& b) {
  EXPECT_EQ(a.from, b.from);
  EXPECT_EQ(a.to, b.to);
  EXPECT_EQ(a.proposer, b.proposer);
  EXPECT_EQ(a.score, b.score);
  EXPECT_EQ(a.score_threshold, b.score_threshold);
  EXPECT_EQ(a.from_tform_to.rotation.coeffs(), b.from_tform_to.rotation.coeffs());
  EXPECT_EQ(a.from_tform_to.translation, b.from_tform_to.translation);
  EXPECT_EQ(a.covariance, b.covariance);
  EXPECT_EQ(a.measured, b.measured);
  ASSERT_EQ(a.registration.has_value(), b.registration.has_value());
  if (!a.registration.has_value()) return;
  EXPECT_EQ(a.registration->converged, b.registration->converged);
  EXPECT_EQ(a.registration->overlap, b.registration->overlap);
  EXPECT_EQ(a.registration->overlap_threshold, b.registration->overlap_threshold);
  EXPECT_EQ(a.registration->residual_m, b.registration->residual_m);
  EXPECT_EQ(a.registration->residual_limit_m, b.registration->residual_limit_m);
  EXPECT_EQ(a.registration->open_directions, b.registration->open_directions);
}

template <typename Kind>
Kind RoundTrip(const Kind& finding, std::vector<MissionId>* missions = nullptr) {
  const FindingRecord record = ToRecord(finding);
  if (missions != nullptr) *missions = record.missions;
  const auto parsed = ParseFinding(record.bytes);
  EXPECT_TRUE(parsed.ok()) << parsed.status();
  const Kind* kind = parsed.ok() ? std::get_if<Kind>(&*parsed) : nullptr;
  EXPECT_NE(kind, nullptr);
  return kind == nullptr ? Kind() : *kind;
}

TEST(MapLog, ASearchComesBackBitByBit) {
  LoopCandidate unmeasured = Measured();
  unmeasured.measured = false;
  unmeasured.registration.reset();
  std::vector<MissionId> missions;
  const SearchResult search =
      RoundTrip(SearchResult{{kBert, 8}, {Measured(), unmeasured}}, &missions);
  EXPECT_EQ(search.node, (NodeId{kBert, 8}));
  ASSERT_EQ(search.candidates.size(), 2u);
  ExpectSame(search.candidates[0], Measured());
  ExpectSame(search.candidates[1], unmeasured);
  EXPECT_THAT(missions, ElementsAre(kBert));
  EXPECT_THAT(RoundTrip(SearchResult{{kBert, 0}, {}}).candidates, IsEmpty());
}

TEST(MapLog, PairsComeBackAndSayWhichMissionsTheyAreAbout) {
  LoopCandidate pair = Measured();
  pair.proposer = LoopEvidence::kRobotScore;
  std::vector<MissionId> missions;
  ExpectSame(RoundTrip(pair, &missions), pair);
  EXPECT_THAT(missions, ElementsAre(kAnna, kBert));
  const auto scored = RoundTrip(ScoredCandidate{{kBert, 1}, {kBert, 2}, 0.25}, &missions);
  EXPECT_EQ(scored.to, (NodeId{kBert, 2}));
  EXPECT_EQ(scored.score, 0.25);
  EXPECT_THAT(missions, ElementsAre(kBert));
}

TEST(MapLog, AMotionComesBackBitByBit) {
  const RefinedMotion motion = {{{kAnna, 4}, Measured().from_tform_to, Measured().covariance},
                                true};
  const RefinedMotion read = RoundTrip(motion);
  EXPECT_EQ(read.measurement.to, motion.measurement.to);
  EXPECT_EQ(read.measurement.previous_from_this.translation,
            motion.measurement.previous_from_this.translation);
  EXPECT_EQ(read.measurement.covariance, motion.measurement.covariance);
  EXPECT_TRUE(read.determined);
}

TEST(MapLog, DecisionsOfEveryKindComeBackAndBelongToNoMission) {
  MapDecisions decisions{42, {}};
  for (const auto decision :
       {ClosureDecision::kForced, ClosureDecision::kVetoed, ClosureDecision::kVetoedAfterForced}) {
    decisions.decisions.push_back({"a/r:1>b/r:2#0", decision});
  }
  std::vector<MissionId> missions = {kAnna};
  const MapDecisions read = RoundTrip(decisions, &missions);
  EXPECT_EQ(read.map_epoch, 42u);
  ASSERT_EQ(read.decisions.size(), 3u);
  for (int i = 0; i < 3; ++i)
    EXPECT_EQ(read.decisions[i].decision, decisions.decisions[i].decision);
  EXPECT_THAT(missions, IsEmpty());
}

TEST(MapLog, WhatIsNoFindingIsDataLoss) {
  const std::string search = ToRecord(SearchResult{{kBert, 8}, {Measured()}}).bytes;
  for (const std::string& bytes :
       {std::string(), std::string("nonsense"), search.substr(0, search.size() / 2)}) {
    EXPECT_FALSE(ParseFinding(bytes).ok()) << bytes.size();
  }
}

}  // namespace
}  // namespace overtone
