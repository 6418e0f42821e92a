// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/revision_history.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/core/mapping/map_test_support.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Pair;
using ::testing::UnorderedElementsAre;

// Keyframes at the given x.
SnapshotMission MissionAt(const std::string& robot, int component, const std::vector<double>& xs) {
  SnapshotMission mission;
  mission.id = Mission(robot);
  mission.component = component;
  mission.anchored = component == 0;
  mission.keyframes = std::vector<Keyframe>(xs.size());
  for (const double x : xs) mission.map_from_body.push_back(Planar(x, 0, 0));
  return mission;
}

using Verdicts = std::vector<std::pair<std::string, ClosureVerdict>>;

std::shared_ptr<MapSnapshot> Snapshot(uint64_t revision, const Verdicts& verdicts,
                                      uint64_t map_epoch = 1) {
  auto snapshot = std::make_shared<MapSnapshot>();
  snapshot->revision = revision;
  snapshot->map_epoch = map_epoch;
  for (const auto& [id, verdict] : verdicts) {
    ClosureRecord& record = snapshot->closures.emplace_back();
    record.id = id;
    record.verdict = verdict;
  }
  return snapshot;
}

constexpr auto kAccepted = ClosureVerdict::kAccepted;
constexpr auto kDemoted = ClosureVerdict::kDemotedByOptimiser;
constexpr auto kForced = ClosureVerdict::kForcedByOperator;
constexpr auto kVetoed = ClosureVerdict::kVetoedByOperator;

TEST(DescribeRevision, TheFirstTakesEverythingIntoUseAndMovesNothing) {
  auto snapshot = Snapshot(1, {{"p", kAccepted}, {"q", kDemoted}, {"r", kForced}}, 7);
  snapshot->missions = {MissionAt("a", 0, {0, 1, 2}), MissionAt("b", 1, {0, 1})};
  snapshot->initial_cost = 5;
  snapshot->final_cost = 3;
  snapshot->optimisation_s = 0.25;
  const RevisionRecord record = DescribeRevision(nullptr, *snapshot);
  EXPECT_EQ(record.revision, 1u);
  EXPECT_EQ(record.map_epoch, 7u);
  EXPECT_EQ(record.missions, 2);
  EXPECT_EQ(record.anchored_missions, 1);
  EXPECT_EQ(record.components, 2);
  EXPECT_EQ(record.keyframes, 5);
  EXPECT_THAT(record.verdicts,
              UnorderedElementsAre(Pair(kAccepted, 1), Pair(kDemoted, 1), Pair(kForced, 1)));
  EXPECT_THAT(record.accepted, ElementsAre("p", "r"));
  EXPECT_THAT(record.dropped, IsEmpty());
  EXPECT_EQ(record.cost_before, 5);
  EXPECT_EQ(record.cost_after, 3);
  EXPECT_EQ(record.optimisation_s, 0.25);
  EXPECT_EQ(record.mean_move_m, 0);
  EXPECT_EQ(record.largest_move_m, 0);
}

TEST(DescribeRevision, OnlyWhatChangesItsUseIsAcceptedOrDropped) {
  const auto before = Snapshot(1, {{"stays", kAccepted},
                                   {"forced", kAccepted},
                                   {"demoted", kAccepted},
                                   {"vetoed", kForced},
                                   {"back", kDemoted},
                                   {"still_out", kDemoted}});
  const auto after = Snapshot(2, {{"stays", kAccepted},
                                  {"forced", kForced},
                                  {"demoted", kDemoted},
                                  {"vetoed", kVetoed},
                                  {"back", kAccepted},
                                  {"still_out", kVetoed},
                                  {"new", kAccepted},
                                  {"new_out", ClosureVerdict::kQuarantined}});
  const RevisionRecord record = DescribeRevision(before.get(), *after);
  EXPECT_THAT(record.accepted, ElementsAre("back", "new"));
  EXPECT_THAT(record.dropped, ElementsAre("demoted", "vetoed"));
  EXPECT_EQ(record.verdicts.at(kAccepted), 3);
  EXPECT_EQ(record.verdicts.at(kVetoed), 2);
}

// a: moves 0, 0.3, and a third keyframe that is new. b: comes into the map, c leaves it, d is new;
// their moves are changes of frame.
TEST(DescribeRevision, MovesAreThoseOfKeyframesAnchoredInBoth) {
  auto before = Snapshot(1, {}), after = Snapshot(2, {});
  before->missions = {MissionAt("a", 0, {0, 1}), MissionAt("b", 1, {0, 1}),
                      MissionAt("c", 0, {0, 1})};
  after->missions = {MissionAt("a", 0, {0, 1.3, 99}), MissionAt("b", 0, {50, 51}),
                     MissionAt("c", 1, {70, 71}), MissionAt("d", 0, {5})};
  const RevisionRecord record = DescribeRevision(before.get(), *after);
  EXPECT_NEAR(record.mean_move_m, 0.15, 1e-12);
  EXPECT_NEAR(record.largest_move_m, 0.3, 1e-12);
  EXPECT_EQ(record.missions, 4);
  EXPECT_EQ(record.anchored_missions, 3);
  EXPECT_EQ(record.components, 2);
  EXPECT_EQ(record.keyframes, 8);
}

TEST(DescribeRevision, MissionsAreFoundByIdNotByPosition) {
  auto before = Snapshot(1, {}), after = Snapshot(2, {});
  before->missions = {MissionAt("b", 0, {10})};
  after->missions = {MissionAt("a", 0, {0}), MissionAt("b", 0, {12})};
  EXPECT_EQ(DescribeRevision(before.get(), *after).largest_move_m, 2);
}

class RevisionHistoryTest : public ::testing::Test {
 protected:
  static void AddFour(RevisionHistory& history) {
    history.Add(Snapshot(1, {{"p", kAccepted}}));
    history.Add(Snapshot(2, {{"p", kAccepted}, {"q", kAccepted}}));
    history.Add(Snapshot(3, {{"p", kVetoed}, {"q", kAccepted}, {"r", kForced}}));
    history.Add(Snapshot(4, {{"p", kAccepted}, {"q", kDemoted}, {"r", kForced}}));
  }
};

TEST_F(RevisionHistoryTest, KnowsWhatWasInUseAtEachRevision) {
  RevisionHistory history;
  EXPECT_EQ(history.InUseAt(1).status().code(), absl::StatusCode::kNotFound);
  AddFour(history);
  EXPECT_THAT(*history.InUseAt(4), ElementsAre("p", "r"));
  EXPECT_THAT(*history.InUseAt(3), ElementsAre("q", "r"));
  EXPECT_THAT(*history.InUseAt(2), ElementsAre("p", "q"));
  EXPECT_THAT(*history.InUseAt(1), ElementsAre("p"));
  EXPECT_EQ(history.InUseAt(0).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(history.InUseAt(5).status().code(), absl::StatusCode::kNotFound);
}

TEST_F(RevisionHistoryTest, BeyondItsCapacityTheOldestIsForgotten) {
  RevisionHistory history(/*capacity=*/2);
  AddFour(history);
  ASSERT_EQ(history.records().size(), 2u);
  EXPECT_EQ(history.records().front().revision, 3u);
  // Still told against the forgotten one.
  EXPECT_THAT(history.records().front().accepted, ElementsAre("r"));
  EXPECT_THAT(history.records().front().dropped, ElementsAre("p"));
  EXPECT_THAT(*history.InUseAt(3), ElementsAre("q", "r"));
  EXPECT_EQ(history.InUseAt(2).status().code(), absl::StatusCode::kNotFound);
}

TEST_F(RevisionHistoryTest, AnotherEpochIsNoWayBack) {
  RevisionHistory history;
  AddFour(history);
  history.Add(Snapshot(5, {{"p", kAccepted}}, /*map_epoch=*/2));
  history.Add(Snapshot(6, {{"p", kAccepted}, {"q", kAccepted}}, 2));
  EXPECT_THAT(*history.InUseAt(6), ElementsAre("p", "q"));
  EXPECT_THAT(*history.InUseAt(5), ElementsAre("p"));
  const absl::Status status = history.InUseAt(4).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kNotFound);
  EXPECT_THAT(std::string(status.message()), testing::HasSubstr("4"));
  EXPECT_EQ(history.records().size(), 6u);
  EXPECT_THAT(history.records()[4].dropped, ElementsAre("r"));
}

}  // namespace
}  // namespace overtone
