// SPDX-License-Identifier: Apache-2.0
// Which loop closures between missions a map believes, and what becomes of the others.
#include <algorithm>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/geometry/trajectory_error.h"
#include "overtone/core/mapping/multi_robot_map.h"
#include "overtone/tests/core/mapping/map_test_support.h"

namespace overtone {
namespace {

using ::testing::Contains;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

const Matrix6d kOdometryNoise = Covariance(0.02, 0.004);
const Matrix6d kClosureNoise = Covariance(0.02, 0.005);
constexpr int kKeyframes = 60;

// Four robots on circles that overlap, each in an odometry frame of its own.
class ClosuresTest : public ::testing::Test {
 protected:
  explicit ClosuresTest(int seed = 5) : random_(seed) {
    const std::vector<Rigid3d> circle = CirclePoses(kKeyframes);
    const std::pair<const char*, std::pair<Rigid3d, Rigid3d>> world_and_mission_from_first[] = {
        {"a", {Rigid3d(), Rigid3d()}},
        {"b", {Planar(6, 3, 1), Planar(-40, 7, 2.5)}},
        {"c", {Planar(-4, 8, -2), Planar(100, 5, -1)}},
        {"d", {Planar(2, -5, 3), Planar(0, -60, 0.4)}}};
    for (const auto& [robot, first] : world_and_mission_from_first) {
      for (const Rigid3d& pose : circle) truth_[robot].push_back(first.first * pose);
      odometry_[robot] = Drifted(truth_[robot], first.second, kOdometryNoise, random_);
    }
  }

  void AddMissions(const std::vector<std::string>& robots) {
    for (const std::string& robot : robots) {
      ASSERT_TRUE(
          map_.AddSubmap(Mission(robot), MakeSubmap(0, 0, odometry_[robot], kOdometryNoise)).ok());
    }
  }

  LoopClosure Right(const NodeId& from, const NodeId& to) {
    return MakeClosure(from, to,
                       truth_[from.mission.robot][from.index].Inverse() *
                           truth_[to.mission.robot][to.index] * Exp(Noise(kClosureNoise, random_)),
                       kClosureNoise);
  }
  LoopClosure Right(const std::string& from, int64_t i, const std::string& to, int64_t j) {
    return Right({Mission(from), i}, {Mission(to), j});
  }
  // As if the second robot's world were another one.
  LoopClosure Elsewhere(const std::string& from, int64_t i, const std::string& to, int64_t j,
                        const Rigid3d& world_from_other_world) {
    LoopClosure closure = Right(from, i, to, j);
    closure.from_tform_to = truth_[from][i].Inverse() * world_from_other_world * truth_[to][j] *
                            Exp(Noise(kClosureNoise, random_));
    return closure;
  }
  LoopClosure Wrong() {
    const auto index = [&] { return static_cast<int64_t>(random_() % kKeyframes); };
    LoopClosure closure = Right("a", index(), "b", index());
    closure.from_tform_to = closure.from_tform_to * Exp(Noise(Covariance(10, 1), random_));
    return closure;
  }
  void Add(const LoopClosure& closure) { ASSERT_TRUE(map_.AddLoopClosure(closure).ok()); }

  // Of the missions named, after one alignment.
  double TeamRmse(const MapSnapshot& snapshot, const std::vector<std::string>& robots) {
    std::vector<Rigid3d> estimate, truth;
    for (const SnapshotMission& mission : snapshot.missions) {
      const std::string& robot = mission.id.robot;
      if (std::find(robots.begin(), robots.end(), robot) == robots.end()) continue;
      estimate.insert(estimate.end(), mission.map_from_body.begin(), mission.map_from_body.end());
      truth.insert(truth.end(), truth_[robot].begin(), truth_[robot].end());
    }
    return AbsoluteTrajectoryError(estimate, truth)->rmse_m;
  }
  static std::vector<std::string> Verdicts(const MapSnapshot& snapshot, size_t first = 0,
                                           size_t end = 1000) {
    std::vector<std::string> verdicts;
    for (size_t k = first; k < std::min(end, snapshot.closures.size()); ++k) {
      verdicts.emplace_back(ToString(snapshot.closures[k].verdict));
    }
    return verdicts;
  }
  static std::vector<int> Components(const MapSnapshot& snapshot) {
    std::vector<int> components;
    for (const SnapshotMission& mission : snapshot.missions) {
      components.push_back(mission.component);
    }
    return components;
  }

  std::mt19937 random_;
  std::map<std::string, std::vector<Rigid3d>> truth_, odometry_;
  MultiRobotMap map_{MultiRobotMapOptions()};
};

// 20 right ones among none, 20 and 80 wrong ones.
class WrongSharesTest : public ClosuresTest, public ::testing::WithParamInterface<int> {
 protected:
  WrongSharesTest() : ClosuresTest(GetParam()) {}
};

TEST_P(WrongSharesTest, NoneOfTheWrongIsAcceptedAndNoneOfTheRightRefused) {
  std::vector<LoopClosure> closures;
  for (int k = 0; k < 20; ++k) closures.push_back(Right("a", 3 * k, "b", (7 * k + 5) % 60));
  double clean_rmse = 0;
  for (const int wrong : {0, 20, 80}) {
    SCOPED_TRACE(wrong);
    while (static_cast<int>(closures.size()) < 20 + wrong) closures.push_back(Wrong());
    std::vector<std::pair<LoopClosure, bool>> shuffled;
    for (size_t k = 0; k < closures.size(); ++k) shuffled.emplace_back(closures[k], k < 20);
    std::shuffle(shuffled.begin(), shuffled.end(), random_);
    map_ = MultiRobotMap(MultiRobotMapOptions());
    AddMissions({"a", "b"});
    for (const auto& [closure, right] : shuffled) Add(closure);
    const auto snapshot = map_.Optimise();
    for (size_t k = 0; k < shuffled.size(); ++k) {
      EXPECT_EQ(InUse(snapshot->closures[k].verdict), shuffled[k].second)
          << ToString(snapshot->closures[k].verdict);
    }
    const double rmse = TeamRmse(*snapshot, {"a", "b"});
    if (wrong == 0) clean_rmse = rmse;
    EXPECT_LT(rmse, 1.05 * clean_rmse + 1e-9);
  }
  EXPECT_LT(clean_rmse, 0.2);
}

INSTANTIATE_TEST_SUITE_P(Seeds, WrongSharesTest, ::testing::Range(1, 6));

TEST_F(ClosuresTest, TwoComponentsOfTwoMissionsEachBecomeOne) {
  AddMissions({"a", "b", "c", "d"});
  for (const int i : {5, 25, 45}) {
    Add(Right("a", i, "b", i + 3));
    Add(Right("d", i, "c", i + 7));
  }
  auto snapshot = map_.Optimise();
  EXPECT_THAT(Components(*snapshot), ElementsAre(0, 0, 1, 1));
  EXPECT_LT(TeamRmse(*snapshot, {"a", "b"}), 0.2);
  EXPECT_LT(TeamRmse(*snapshot, {"c", "d"}), 0.2);
  // Two agree, and a third between the same components but other missions says nothing about them.
  Add(Right("b", 10, "c", 50));
  Add(Right("b", 30, "c", 20));
  Add(Right("a", 30, "d", 20));
  snapshot = map_.Optimise();
  EXPECT_THAT(Components(*snapshot), ElementsAre(0, 0, 1, 1));
  EXPECT_THAT(Verdicts(*snapshot, 6), Each("quarantined"));
  Add(Right("b", 50, "c", 5));
  snapshot = map_.Optimise();
  EXPECT_THAT(Components(*snapshot), Each(0));
  EXPECT_THAT(Verdicts(*snapshot), Each("accepted"));
  EXPECT_LT(TeamRmse(*snapshot, {"a", "b", "c", "d"}), 0.2);
  // a defines the map frame.
  EXPECT_LT(Log(odometry_["a"][0].Inverse() * snapshot->missions[0].map_from_body[0]).norm(), 1e-9);
}

// The optimiser finds nothing left to do: exact closures align exact odometry before it.
TEST_F(ClosuresTest, JoiningStartsTheOptimiserAtTheRightAlignment) {
  for (const char* robot : {"a", "b"}) {
    std::vector<Rigid3d> odometry;
    for (const Rigid3d& pose : truth_[robot]) odometry.push_back(Planar(70, 8, -2) * pose);
    odometry_[robot] = odometry;
    for (Rigid3d& pose : odometry_["b"]) pose = Planar(-5, 3, 1) * pose;
  }
  AddMissions({"a", "b"});
  for (const int i : {5, 25, 45}) {
    const Rigid3d b_from_a = truth_["b"][i + 3].Inverse() * truth_["a"][i];
    Add(MakeClosure({Mission("b"), i + 3}, {Mission("a"), i}, b_from_a));
  }
  const auto snapshot = map_.Optimise();
  EXPECT_THAT(Components(*snapshot), Each(0));
  EXPECT_LT(snapshot->initial_cost, 1e-9);
}

// The closures of a place that looks the same agree with each other.
TEST_F(ClosuresTest, AWrongSetThatCameFirstIsOverruledByALargerOne) {
  AddMissions({"a", "b"});
  const Rigid3d elsewhere = Planar(25, -10, 1.5);
  for (const int i : {5, 25, 45}) Add(Elsewhere("a", i, "b", i + 3, elsewhere));
  auto snapshot = map_.Optimise();
  EXPECT_THAT(Verdicts(*snapshot), Each("accepted"));
  EXPECT_GT(TeamRmse(*snapshot, {"a", "b"}), 2);
  // As many right ones do not yet overrule.
  for (const int i : {10, 30, 50}) Add(Right("a", i, "b", i - 4));
  snapshot = map_.Optimise();
  EXPECT_THAT(Verdicts(*snapshot, 0, 3), Each("accepted"));
  EXPECT_THAT(Verdicts(*snapshot, 3), Each("rejected_inconsistent"));
  EXPECT_EQ(snapshot->closures[3].consistent_set, 3);
  Add(Right("a", 20, "b", 40));
  snapshot = map_.Optimise();
  EXPECT_THAT(Verdicts(*snapshot, 0, 3), Each("rejected_inconsistent"));
  EXPECT_THAT(Verdicts(*snapshot, 3), Each("accepted"));
  EXPECT_TRUE(snapshot->missions[1].anchored);
  EXPECT_LT(TeamRmse(*snapshot, {"a", "b"}), 0.2);
  EXPECT_EQ(Reason(snapshot->closures[0]),
            "disagrees with the 4 closures that agree between its two missions");
  const RevisionRecord& record = map_.history().records().back();
  EXPECT_EQ(record.accepted.size(), 4u);
  EXPECT_THAT(record.dropped,
              ElementsAre("a/m0:25>b/m0:28#0", "a/m0:45>b/m0:48#0", "a/m0:5>b/m0:8#0"));
}

TEST_F(ClosuresTest, VetoingOneOfASetLetsTheOthersStand) {
  AddMissions({"a", "b"});
  for (const int i : {5, 25, 45}) Add(Right("a", i, "b", i + 3));
  map_.Optimise();
  ASSERT_TRUE(map_.Veto("a/m0:25>b/m0:28#0").ok());
  const auto snapshot = map_.Optimise();
  EXPECT_THAT(Verdicts(*snapshot), ElementsAre("accepted", "vetoed_by_operator", "accepted"));
  EXPECT_TRUE(snapshot->missions[1].anchored);
  EXPECT_EQ(snapshot->closures[0].consistent_set, 2);
  EXPECT_EQ(snapshot->closures[0].since_revision, 1u);
  EXPECT_EQ(snapshot->closures[1].weight, 0);
  EXPECT_LT(TeamRmse(*snapshot, {"a", "b"}), 0.3);
}

// What the vetoed set had outvoted is a first tie now.
TEST_F(ClosuresTest, VetoingAWholeSetPutsWhatItHadOutvotedIntoQuarantine) {
  AddMissions({"a", "b"});
  for (const int i : {5, 25, 45}) Add(Elsewhere("a", i, "b", i + 3, Planar(25, -10, 1.5)));
  Add(Right("a", 10, "b", 6));
  map_.Optimise();
  for (const int i : {5, 25, 45}) {
    ASSERT_TRUE(
        map_.Veto("a/m0:" + std::to_string(i) + ">b/m0:" + std::to_string(i + 3) + "#0").ok());
  }
  auto snapshot = map_.Optimise();
  EXPECT_THAT(Verdicts(*snapshot, 3), ElementsAre("quarantined"));
  EXPECT_FALSE(snapshot->missions[1].anchored);
  for (const int i : {30, 50}) Add(Right("a", i, "b", i - 4));
  snapshot = map_.Optimise();
  EXPECT_THAT(Verdicts(*snapshot, 3), Each("accepted"));
  EXPECT_LT(TeamRmse(*snapshot, {"a", "b"}), 0.2);
}

TEST_F(ClosuresTest, CandidatesThatFailOnTheirFiguresStayListedAndDoNotVote) {
  AddMissions({"a", "b"});
  for (const int i : {5, 25, 45}) Add(Right("a", i, "b", i + 3));
  const auto clean = map_.Optimise();
  for (const int i : {1, 11, 21, 31}) {
    LoopCandidate candidate = CandidateOf(Elsewhere("a", i, "b", i + 3, Planar(25, -10, 1.5)));
    candidate.registration = RegistrationFigures{true, 0.9, 0.6, 0.2, 0.15, 0};
    ASSERT_TRUE(map_.AddCandidate(candidate).ok());
  }
  for (int revision = 2; revision < 4; ++revision) {
    const auto snapshot = map_.Optimise();
    EXPECT_THAT(Verdicts(*snapshot, 0, 3), Each("accepted"));
    EXPECT_THAT(Verdicts(*snapshot, 3), Each("rejected_residual"));
    ASSERT_EQ(snapshot->closures.size(), 7u);
    EXPECT_EQ(snapshot->closures[3].since_revision, 2u);
    EXPECT_EQ(snapshot->closures[3].weight, 0);
    EXPECT_EQ(snapshot->closures[0].consistent_set, 3);
    EXPECT_NEAR(snapshot->final_cost, clean->final_cost, 1e-6 * clean->final_cost);
    EXPECT_THAT(map_.history().records().back().dropped, IsEmpty());
  }
}

TEST_F(ClosuresTest, FiguresCountForACandidateThatCameBeforeItsKeyframes) {
  LoopCandidate candidate = CandidateOf(Right("a", 5, "b", 8));
  candidate.registration = RegistrationFigures{true, 0.3, 0.6, 0.1, 0.15, 0};
  AddMissions({"a"});
  ASSERT_TRUE(map_.AddCandidate(candidate).ok());
  EXPECT_THAT(Verdicts(*map_.Optimise()), ElementsAre("pending"));
  AddMissions({"b"});
  EXPECT_THAT(Verdicts(*map_.Optimise()), ElementsAre("rejected_overlap"));
}

// Within one mission: alone it fits what the odometry allows; three better ones say otherwise.
TEST_F(ClosuresTest, ADemotedClosureSaysSinceWhenAndTheHistoryThatItWasDropped) {
  AddMissions({"a"});
  LoopClosure wrong = Right("a", 59, "a", 0);
  wrong.from_tform_to.translation += Eigen::Vector3d(1.0, 0, 0);
  Add(wrong);
  auto snapshot = map_.Optimise();
  ASSERT_EQ(ToString(snapshot->closures[0].verdict), "accepted") << Reason(snapshot->closures[0]);
  for (const int i : {0, 1, 2}) Add(Right("a", 58 - i, "a", i));
  snapshot = map_.Optimise();
  EXPECT_THAT(Verdicts(*snapshot),
              ElementsAre("demoted_by_optimiser", "accepted", "accepted", "accepted"));
  EXPECT_EQ(snapshot->closures[0].since_revision, 2u);
  EXPECT_EQ(snapshot->closures[0].weight, 0);
  EXPECT_GT(snapshot->closures[0].chi_square, 22.46);
  EXPECT_THAT(map_.history().records().back().dropped, ElementsAre("a/m0:59>a/m0:0#0"));
  EXPECT_LT(TeamRmse(*snapshot, {"a"}), 0.2);
  // It is said once.
  snapshot = map_.Optimise();
  EXPECT_EQ(snapshot->closures[0].since_revision, 2u);
  EXPECT_THAT(map_.history().records().back().dropped, IsEmpty());
}

// Pairs of one place, passed in directions that differ by more and more: a score says nothing of
// the heading, so they neither contradict measured closures nor outvote them.
class ScoredPairsTest : public ClosuresTest {
 protected:
  // The keyframes of b nearest to those of a.
  std::vector<ScoredCandidate> RightPairs() {
    std::vector<ScoredCandidate> pairs;
    for (int64_t i = 0; i < kKeyframes; ++i) {
      for (int64_t j = 0; j < kKeyframes; ++j) {
        if ((truth_["a"][i].translation - truth_["b"][j].translation).norm() < 1) {
          pairs.push_back({{Mission("a"), i}, {Mission("b"), j}, 0.9});
        }
      }
    }
    return pairs;
  }
  std::vector<ScoredCandidate> WrongPairs(int n) {
    std::vector<ScoredCandidate> pairs;
    while (static_cast<int>(pairs.size()) < n) {
      const auto index = [&] { return static_cast<int64_t>(random_() % kKeyframes); };
      const int64_t i = index(), j = index();
      if ((truth_["a"][i].translation - truth_["b"][j].translation).norm() < 6) continue;
      pairs.push_back({{Mission("a"), i}, {Mission("b"), j}, 0.9});
    }
    return pairs;
  }
  void Add(const std::vector<ScoredCandidate>& pairs) {
    for (const ScoredCandidate& pair : pairs) ASSERT_TRUE(map_.AddScoredCandidate(pair).ok());
  }
};

TEST_F(ScoredPairsTest, WrongOnesDoNotOutvoteMeasuredClosures) {
  AddMissions({"a", "b"});
  for (const int i : {5, 25, 45}) ClosuresTest::Add(Right("a", i, "b", i + 3));
  Add(WrongPairs(20));
  const auto snapshot = map_.Optimise();
  EXPECT_THAT(Verdicts(*snapshot, 0, 3), Each("accepted"));
  EXPECT_THAT(Verdicts(*snapshot, 3), Each(testing::Ne("accepted")));
  EXPECT_LT(TeamRmse(*snapshot, {"a", "b"}), 0.2);
}

TEST_F(ScoredPairsTest, RightOnesAgreeWithMeasuredClosuresWhateverTheirHeading) {
  AddMissions({"a", "b"});
  for (const int i : {5, 25, 45}) ClosuresTest::Add(Right("a", i, "b", i + 3));
  const std::vector<ScoredCandidate> pairs = RightPairs();
  ASSERT_GE(pairs.size(), 3u);
  Add(pairs);
  const auto snapshot = map_.Optimise();
  EXPECT_THAT(Verdicts(*snapshot), Each("accepted"));
  EXPECT_LT(TeamRmse(*snapshot, {"a", "b"}), 0.2);
}

TEST_F(ScoredPairsTest, WrongOnesAloneDoNotJoinTwoMissions) {
  for (const int n : {3, 6, 12, 24}) {
    map_ = MultiRobotMap(MultiRobotMapOptions());
    AddMissions({"a", "b"});
    Add(WrongPairs(n));
    EXPECT_FALSE(map_.Optimise()->missions[1].anchored) << n;
  }
}

// They came into use by the measured set, and do not outlive it.
TEST_F(ScoredPairsTest, TheyDoNotKeepMissionsJoinedWhenTheMeasuredClosuresAreVetoed) {
  AddMissions({"a", "b"});
  for (const int i : {5, 25, 45}) ClosuresTest::Add(Right("a", i, "b", i + 3));
  Add(RightPairs());
  EXPECT_THAT(Verdicts(*map_.Optimise()), Each("accepted"));
  for (const int i : {5, 25, 45}) {
    ASSERT_TRUE(
        map_.Veto("a/m0:" + std::to_string(i) + ">b/m0:" + std::to_string(i + 3) + "#0").ok());
  }
  const auto snapshot = map_.Optimise();
  EXPECT_FALSE(snapshot->missions[1].anchored);
  EXPECT_THAT(Verdicts(*snapshot, 3), Each("quarantined"));
}

TEST_F(ScoredPairsTest, TheyDoNotVouchForAMeasuredClosure) {
  AddMissions({"a", "b"});
  ClosuresTest::Add(Elsewhere("a", 5, "b", 8, Planar(25, -10, 1.5)));
  Add(WrongPairs(4));
  const auto snapshot = map_.Optimise();
  EXPECT_THAT(Verdicts(*snapshot, 0, 1), ElementsAre("quarantined"));
  EXPECT_FALSE(snapshot->missions[1].anchored);
}

}  // namespace
}  // namespace overtone
