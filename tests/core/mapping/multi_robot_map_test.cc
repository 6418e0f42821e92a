// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/multi_robot_map.h"

#include <limits>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/core/mapping/map_test_support.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

double PositionError(const Rigid3d& a, const Rigid3d& b) {
  return (a.translation - b.translation).norm();
}

MultiRobotMap MakeMap(MultiRobotMapOptions::Robust robust = MultiRobotMapOptions::Robust::kGnc) {
  MultiRobotMapOptions options;
  options.robust = robust;
  options.min_consistent_closures = 1;  // here one tie is believed; map_evidence_test has more
  return MultiRobotMap(options);
}

void Add(MultiRobotMap& map, const std::string& robot, const Submap& submap) {
  const absl::Status status = map.AddSubmap(Mission(robot), submap);
  ASSERT_TRUE(status.ok()) << status;
}

void Add(MultiRobotMap& map, const LoopClosure& closure) {
  const absl::Status status = map.AddLoopClosure(closure);
  ASSERT_TRUE(status.ok()) << status;
}

TEST(MultiRobotMapOptions, DefaultsAreValid) {
  EXPECT_TRUE(MultiRobotMapOptions().Validate().ok());
}

TEST(MultiRobotMapOptions, RefusesALimitThatIsNotPositive) {
  MultiRobotMapOptions options;
  options.closure_chi_square_limit = 0;
  EXPECT_THAT(std::string(options.Validate().message()), HasSubstr("closure_chi_square_limit"));
}

TEST(MultiRobotMap, AnEmptyMapHasASnapshotWithoutMissions) {
  MultiRobotMap map = MakeMap();
  EXPECT_FALSE(map.dirty());
  const auto snapshot = map.Optimise();
  EXPECT_EQ(snapshot->revision, 1);
  EXPECT_TRUE(snapshot->missions.empty());
}

TEST(MultiRobotMap, WithoutClosuresPosesAreTheOdometry) {
  MultiRobotMap map = MakeMap();
  const std::vector<Rigid3d> odometry = CirclePoses(20);
  Add(map, "a", MakeSubmap(0, 0, odometry));
  EXPECT_TRUE(map.dirty());
  const auto snapshot = map.Optimise();
  EXPECT_FALSE(map.dirty());
  ASSERT_EQ(snapshot->missions.size(), 1);
  EXPECT_TRUE(snapshot->missions[0].anchored);
  for (int i = 0; i < 20; ++i) {
    EXPECT_LT(PositionError(snapshot->missions[0].map_from_body[i], odometry[i]), 1e-9);
  }
}

// A unit square driven with one motion error d at the last side and closed exactly. All five edges
// are alike and translations only, so each takes a fifth of the error.
TEST(MultiRobotMap, ASquareLoopSpreadsItsErrorEvenly) {
  MultiRobotMap map = MakeMap(MultiRobotMapOptions::Robust::kNone);
  const Matrix6d stiff_rotation = Covariance(0.1, 1e-6);
  Add(map, "a",
      MakeSubmap(
          0, 0,
          {Planar(0, 0, 0), Planar(1, 0, 0), Planar(1, 1, 0), Planar(0, 1, 0), Planar(0.5, 0, 0)},
          stiff_rotation));
  Add(map, MakeClosure({Mission("a"), 4}, {Mission("a"), 0}, Planar(0, 0, 0), stiff_rotation));
  const auto snapshot = map.Optimise();
  const std::vector<Rigid3d>& poses = snapshot->missions[0].map_from_body;
  EXPECT_NEAR(poses[0].translation.x(), 0, 1e-12);
  EXPECT_NEAR(poses[1].translation.x(), 0.9, 1e-6);
  EXPECT_NEAR(poses[2].translation.x(), 0.8, 1e-6);
  EXPECT_NEAR(poses[3].translation.x(), -0.3, 1e-6);
  EXPECT_NEAR(poses[4].translation.x(), 0.1, 1e-6);
  // Five residuals of 0.1 m at sigma 0.1 m.
  EXPECT_NEAR(snapshot->final_cost, 0.5 * 5, 1e-6);
  EXPECT_NEAR(snapshot->closures[0].chi_square, 1, 1e-6);
}

TEST(MultiRobotMap, TwoRobotsThatMeetShareTheOlderOnesFrame) {
  MultiRobotMap map = MakeMap();
  const std::vector<Rigid3d> odometry = CirclePoses(12);
  Add(map, "b", MakeSubmap(0, 0, odometry));
  Add(map, "a", MakeSubmap(0, 0, odometry));
  auto snapshot = map.Optimise();
  EXPECT_FALSE(snapshot->missions[0].anchored);  // "a" came second; sorted by id it is first
  EXPECT_EQ(snapshot->missions[0].component, 1);
  EXPECT_TRUE(snapshot->missions[1].anchored);

  // Keyframe 3 of "a" stands 2 m to the left of keyframe 5 of "b" and looks the other way.
  const Rigid3d b5_from_a3 = Planar(0, 2, M_PI);
  Add(map, MakeClosure({Mission("b"), 5}, {Mission("a"), 3}, b5_from_a3));
  snapshot = map.Optimise();
  EXPECT_EQ(snapshot->revision, 2);
  EXPECT_TRUE(snapshot->missions[0].anchored);
  EXPECT_EQ(snapshot->missions[0].component, 0);
  const Rigid3d map_from_a = odometry[5] * b5_from_a3 * odometry[3].Inverse();
  EXPECT_LT(Log(map_from_a.Inverse() * snapshot->missions[0].map_from_mission).norm(), 1e-9);
  for (int i = 0; i < 12; ++i) {
    EXPECT_LT(PositionError(snapshot->missions[0].map_from_body[i], map_from_a * odometry[i]),
              1e-9);
    EXPECT_LT(PositionError(snapshot->missions[1].map_from_body[i], odometry[i]), 1e-9);
  }
}

TEST(MultiRobotMap, AClosureWrittenFromTheYoungerMissionJoinsJustTheSame) {
  const std::vector<Rigid3d> odometry = CirclePoses(12);
  const Rigid3d b5_from_a3 = Planar(1, 2, 0.7);
  std::vector<Rigid3d> map_from_mission;
  for (const bool reversed : {false, true}) {
    MultiRobotMap map = MakeMap();
    Add(map, "b", MakeSubmap(0, 0, odometry));
    Add(map, "a", MakeSubmap(0, 0, odometry));
    Add(map, reversed ? MakeClosure({Mission("a"), 3}, {Mission("b"), 5}, b5_from_a3.Inverse())
                      : MakeClosure({Mission("b"), 5}, {Mission("a"), 3}, b5_from_a3));
    map_from_mission.push_back(map.Optimise()->missions[0].map_from_mission);
  }
  EXPECT_LT(Log(map_from_mission[0].Inverse() * map_from_mission[1]).norm(), 1e-9);
}

TEST(MultiRobotMap, ThreeComponentsKeepTheirOwnFramesUntilTied) {
  MultiRobotMap map = MakeMap();
  const std::vector<Rigid3d> odometry = CirclePoses(8);
  for (const char* robot : {"a", "b", "c", "d"}) Add(map, robot, MakeSubmap(0, 0, odometry));
  Add(map, MakeClosure({Mission("b"), 0}, {Mission("d"), 0}, Planar(5, 0, 0)));
  auto snapshot = map.Optimise();
  const auto components = [&] {
    std::vector<int> result;
    for (const SnapshotMission& mission : snapshot->missions) result.push_back(mission.component);
    return result;
  };
  EXPECT_THAT(components(), testing::ElementsAre(0, 1, 2, 1));
  EXPECT_NEAR(snapshot->missions[3].map_from_body[0].translation.x(), 5, 1e-9);

  // d carries b along.
  Add(map, MakeClosure({Mission("a"), 0}, {Mission("d"), 0}, Planar(0, 100, 0)));
  snapshot = map.Optimise();
  EXPECT_THAT(components(), testing::ElementsAre(0, 0, 1, 0));
  EXPECT_NEAR(snapshot->missions[3].map_from_body[0].translation.y(), 100, 1e-9);
  EXPECT_NEAR(snapshot->missions[1].map_from_body[0].translation.x(), -5, 1e-9);
  EXPECT_NEAR(snapshot->missions[1].map_from_body[0].translation.y(), 100, 1e-9);
}

TEST(MultiRobotMap, MapFromMissionTakesTheLastOdometryPoseToTheLastMapPose) {
  MultiRobotMap map = MakeMap();
  std::mt19937 random(7);
  const std::vector<Rigid3d> truth = CirclePoses(30);
  Add(map, "a",
      MakeSubmap(0, 0, Drifted(truth, Planar(3, 1, 0.4), Covariance(0.05, 0.02), random)));
  Add(map, MakeClosure({Mission("a"), 29}, {Mission("a"), 0}, truth[29].Inverse() * truth[0]));
  const auto snapshot = map.Optimise();
  const SnapshotMission& mission = snapshot->missions[0];
  const Rigid3d last = mission.map_from_mission * mission.keyframes.back().mission_from_body;
  EXPECT_LT(Log(last.Inverse() * mission.map_from_body.back()).norm(), 1e-9);
}

TEST(MultiRobotMap, NewKeyframesFollowTheCorrectedEndByOdometry) {
  MultiRobotMap map = MakeMap(MultiRobotMapOptions::Robust::kNone);
  std::mt19937 random(7);
  const std::vector<Rigid3d> truth = CirclePoses(30);
  const std::vector<Rigid3d> odometry = Drifted(truth, Rigid3d(), Covariance(0.05, 0.02), random);
  Add(map, "a", MakeSubmap(0, 0, {odometry.begin(), odometry.begin() + 20}));
  Add(map, MakeClosure({Mission("a"), 19}, {Mission("a"), 0}, truth[19].Inverse() * truth[0]));
  const auto before = map.Optimise();
  Add(map, "a", MakeSubmap(1, 20, {odometry.begin() + 20, odometry.end()}));
  const auto after = map.Optimise();
  ASSERT_EQ(after->missions[0].map_from_body.size(), 30);
  EXPECT_THAT(after->missions[0].submap_starts, testing::ElementsAre(0, 20));
  const Rigid3d expected =
      before->missions[0].map_from_body[19] * odometry[19].Inverse() * odometry[29];
  EXPECT_LT(Log(expected.Inverse() * after->missions[0].map_from_body[29]).norm(), 1e-6);
  // The earlier snapshot is frozen.
  EXPECT_EQ(before->missions[0].map_from_body.size(), 20);
}

TEST(MultiRobotMap, APendingClosureIsAcceptedWhenItsKeyframeArrives) {
  MultiRobotMap map = MakeMap();
  const std::vector<Rigid3d> odometry = CirclePoses(8);
  Add(map, MakeClosure({Mission("a"), 1}, {Mission("b"), 6}, Planar(1, 0, 0)));
  Add(map, "a", MakeSubmap(0, 0, odometry));
  Add(map, "b", MakeSubmap(0, 0, {odometry.begin(), odometry.begin() + 4}));
  auto snapshot = map.Optimise();
  EXPECT_EQ(snapshot->closures[0].verdict, ClosureVerdict::kPending);
  EXPECT_FALSE(snapshot->missions[1].anchored);

  Add(map, "b", MakeSubmap(1, 4, {odometry.begin() + 4, odometry.end()}));
  snapshot = map.Optimise();
  EXPECT_EQ(snapshot->closures[0].verdict, ClosureVerdict::kAccepted);
  EXPECT_EQ(snapshot->closures[0].weight, 1);
  EXPECT_TRUE(snapshot->missions[1].anchored);
}

TEST(MultiRobotMap, TheSameClosureTwiceCountsOnce) {
  MultiRobotMap map = MakeMap();
  Add(map, "a", MakeSubmap(0, 0, CirclePoses(8)));
  const LoopClosure closure = MakeClosure({Mission("a"), 7}, {Mission("a"), 0}, Planar(1, 0, 0.7));
  Add(map, closure);
  const auto once = map.Optimise();
  Add(map, closure);
  EXPECT_FALSE(map.dirty());
  const auto twice = map.Optimise();
  EXPECT_EQ(twice->closures.size(), 1);
  EXPECT_NEAR(twice->final_cost, once->final_cost, 1e-9 * once->final_cost + 1e-12);
}

// Two robots around the same circle, in unrelated odometry frames, with every second keyframe
// measured from the other robot's; then wrong closures, metres and radians off.
class OutlierTest : public ::testing::Test {
 protected:
  static constexpr int kRight = 30;

  OutlierTest() {
    std::mt19937 random(11);
    for (const Rigid3d& start : {truth_[0], Planar(40, -20, 2)}) {
      odometry_.push_back(Drifted(truth_, start, odometry_noise_, random));
    }
    for (int i = 0; i < 2 * kRight; i += 2) {
      right_.push_back(MakeClosure({Mission("a"), i}, {Mission("b"), i},
                                   Exp(Noise(closure_noise_, random)), closure_noise_));
    }
    for (int k = 0; k < kRight; ++k) {
      const int64_t i = static_cast<int64_t>(random() % 60),
                    j = static_cast<int64_t>(random() % 60);
      wrong_.push_back(MakeClosure({Mission("a"), i}, {Mission("b"), j},
                                   Exp(Noise(Covariance(10, 1), random)), closure_noise_));
    }
  }

  std::shared_ptr<const MapSnapshot> Optimise(int num_wrong) {
    MultiRobotMap map = MakeMap();
    Build(num_wrong, map);
    return map.Optimise();
  }
  void Build(int num_wrong, MultiRobotMap& map) {
    Add(map, "a", MakeSubmap(0, 0, odometry_[0], odometry_noise_));
    Add(map, "b", MakeSubmap(0, 0, odometry_[1], odometry_noise_));
    for (const LoopClosure& closure : right_) Add(map, closure);
    for (int k = 0; k < num_wrong; ++k) Add(map, wrong_[k]);
  }
  double Rmse(const MapSnapshot& snapshot) const {
    double sum = 0;
    for (const SnapshotMission& mission : snapshot.missions) {
      for (size_t i = 0; i < truth_.size(); ++i) {
        sum += std::pow(PositionError(mission.map_from_body[i], truth_[i]), 2);
      }
    }
    return std::sqrt(sum / (snapshot.missions.size() * truth_.size()));
  }
  void ExpectTheRightOnesOnly(const MapSnapshot& snapshot) const {
    for (int k = 0; k < static_cast<int>(snapshot.closures.size()); ++k) {
      EXPECT_EQ(
          ToString(snapshot.closures[k].verdict),
          ToString(k < kRight ? ClosureVerdict::kAccepted : ClosureVerdict::kRejectedInconsistent))
          << "closure " << k << ", chi square " << snapshot.closures[k].chi_square;
    }
  }

  const std::vector<Rigid3d> truth_ = CirclePoses(60);
  const Matrix6d odometry_noise_ = Covariance(0.02, 0.004);
  const Matrix6d closure_noise_ = Covariance(0.02, 0.005);
  std::vector<std::vector<Rigid3d>> odometry_;
  std::vector<LoopClosure> right_, wrong_;
};

TEST_F(OutlierTest, HalfOfTheClosuresMayBeWrong) {
  const double clean_rmse = Rmse(*Optimise(0));
  for (const int num_wrong : {1, 10, 30}) {
    SCOPED_TRACE(num_wrong);
    const auto snapshot = Optimise(num_wrong);
    ExpectTheRightOnesOnly(*snapshot);
    EXPECT_LT(Rmse(*snapshot), 1.05 * clean_rmse);
  }
}

TEST_F(OutlierTest, AVerdictStandsWhenNothingNewSpeaksAgainstIt) {
  MultiRobotMap map = MakeMap();
  Build(/*num_wrong=*/10, map);
  const auto first = map.Optimise();
  const auto second = map.Optimise();
  ExpectTheRightOnesOnly(*second);
  EXPECT_NEAR(second->final_cost, first->final_cost, 1e-6 * first->final_cost);
}

TEST_F(OutlierTest, WrongClosuresThatComeFirstAreOverruledLater) {
  MultiRobotMap map = MakeMap();
  Add(map, "a", MakeSubmap(0, 0, odometry_[0], odometry_noise_));
  Add(map, "b", MakeSubmap(0, 0, odometry_[1], odometry_noise_));
  for (int k = 0; k < 10; ++k) Add(map, wrong_[k]);
  map.Optimise();
  for (const LoopClosure& closure : right_) Add(map, closure);
  const auto snapshot = map.Optimise();
  for (int k = 0; k < 10; ++k) {
    EXPECT_EQ(snapshot->closures[k].verdict, ClosureVerdict::kRejectedInconsistent) << k;
  }
  EXPECT_LT(Rmse(*snapshot), 1.05 * Rmse(*Optimise(0)));
}

TEST(MultiRobotMap, TwoRightClosuresOverruleAnEarlierWrongOne) {
  MultiRobotMap map = MakeMap();
  const std::vector<Rigid3d> odometry = CirclePoses(20);
  Add(map, "a", MakeSubmap(0, 0, odometry));
  Add(map, "b", MakeSubmap(0, 0, odometry));
  Add(map, MakeClosure({Mission("a"), 4}, {Mission("b"), 4}, Planar(30, 0, 2)));
  EXPECT_EQ(map.Optimise()->closures[0].verdict,
            ClosureVerdict::kAccepted);  // nothing speaks against it
  for (const int i : {9, 12})
    Add(map, MakeClosure({Mission("a"), i}, {Mission("b"), i}, Rigid3d()));
  const auto snapshot = map.Optimise();
  EXPECT_EQ(snapshot->closures[0].verdict, ClosureVerdict::kRejectedInconsistent);
  EXPECT_EQ(snapshot->closures[1].verdict, ClosureVerdict::kAccepted);
  EXPECT_EQ(snapshot->closures[2].verdict, ClosureVerdict::kAccepted);
  EXPECT_LT(PositionError(snapshot->missions[1].map_from_body[0], odometry[0]), 1e-3);
}

TEST(MultiRobotMap, TheSameInputGivesTheSameBits) {
  std::vector<std::shared_ptr<const MapSnapshot>> snapshots;
  for (int run = 0; run < 2; ++run) {
    std::mt19937 random(3);
    MultiRobotMap map = MakeMap();
    const std::vector<Rigid3d> truth = CirclePoses(40);
    Add(map, "a", MakeSubmap(0, 0, Drifted(truth, Rigid3d(), Covariance(0.05, 0.02), random)));
    Add(map, MakeClosure({Mission("a"), 39}, {Mission("a"), 0}, truth[39].Inverse() * truth[0]));
    snapshots.push_back(map.Optimise());
  }
  for (int i = 0; i < 40; ++i) {
    EXPECT_EQ(snapshots[0]->missions[0].map_from_body[i].ToMatrix(),
              snapshots[1]->missions[0].map_from_body[i].ToMatrix());
  }
}

struct BadSubmap {
  std::string name;
  absl::StatusCode code;
  std::string message;
  void (*spoil)(Submap&);
};

class BadSubmapTest : public ::testing::TestWithParam<BadSubmap> {};

TEST_P(BadSubmapTest, IsRefusedByNameAndChangesNothing) {
  const std::vector<Rigid3d> odometry = CirclePoses(8);
  MultiRobotMap map = MakeMap();
  Add(map, "a", MakeSubmap(0, 0, {odometry.begin(), odometry.begin() + 4}));
  const auto before = map.Optimise();
  Submap submap = MakeSubmap(1, 4, {odometry.begin() + 4, odometry.end()});
  submap.loop_closures = {MakeClosure({Mission("a"), 7}, {Mission("a"), 0}, Planar(1, 0, 0))};
  Submap spoilt = submap;
  GetParam().spoil(spoilt);
  const absl::Status status = map.AddSubmap(Mission("a"), spoilt);
  EXPECT_EQ(status.code(), GetParam().code) << status;
  EXPECT_THAT(std::string(status.message()), HasSubstr(GetParam().message));
  EXPECT_FALSE(map.dirty());
  const auto after = map.Optimise();
  EXPECT_EQ(after->missions[0].keyframes.size(), 4);
  EXPECT_TRUE(after->closures.empty());
  EXPECT_TRUE(map.AddSubmap(Mission("a"), submap).ok());
}

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr auto kInvalid = absl::StatusCode::kInvalidArgument;

INSTANTIATE_TEST_SUITE_P(
    Fields, BadSubmapTest,
    ::testing::Values(
        BadSubmap{"SequenceGap", absl::StatusCode::kOutOfRange, "sequence: expected 1, got 2",
                  [](Submap& s) { s.sequence = 2; }},
        BadSubmap{"IndexGap", absl::StatusCode::kOutOfRange, "first_index: expected 4, got 5",
                  [](Submap& s) { s.first_index = 5; }},
        BadSubmap{"IndexOverlap", absl::StatusCode::kOutOfRange, "first_index: expected 4, got 3",
                  [](Submap& s) { s.first_index = 3; }},
        BadSubmap{"Empty", kInvalid, "keyframes: empty", [](Submap& s) { s.keyframes.clear(); }},
        BadSubmap{"StampRepeats", kInvalid, "keyframes[2].stamp",
                  [](Submap& s) { s.keyframes[2].stamp = s.keyframes[1].stamp; }},
        BadSubmap{"StampBeforePreviousSubmap", kInvalid, "keyframes[0].stamp",
                  [](Submap& s) { s.keyframes[0].stamp.ns = 0; }},
        BadSubmap{"PoseNan", kInvalid, "keyframes[3].mission_from_body",
                  [](Submap& s) { s.keyframes[3].mission_from_body.translation.y() = kNan; }},
        BadSubmap{"PoseFarOut", kInvalid, "keyframes[0].mission_from_body",
                  [](Submap& s) { s.keyframes[0].mission_from_body.translation.z() = 1e300; }},
        BadSubmap{"QuaternionZero", kInvalid, "keyframes[1].mission_from_body",
                  [](Submap& s) { s.keyframes[1].mission_from_body.rotation.coeffs().setZero(); }},
        BadSubmap{"CovarianceInfinite", kInvalid, "keyframes[0].motion_covariance",
                  [](Submap& s) { s.keyframes[0].motion_covariance(2, 2) = kInfinity; }},
        BadSubmap{"CovarianceIndefinite", kInvalid, "keyframes[0].motion_covariance",
                  [](Submap& s) { s.keyframes[0].motion_covariance(5, 5) = -1e-3; }},
        BadSubmap{"CovarianceZero", kInvalid, "keyframes[0].motion_covariance",
                  [](Submap& s) { s.keyframes[0].motion_covariance.setZero(); }},
        BadSubmap{"CovarianceAsymmetric", kInvalid, "keyframes[0].motion_covariance",
                  [](Submap& s) { s.keyframes[0].motion_covariance(5, 0) = 1e-6; }},
        BadSubmap{"CovarianceTiny", kInvalid, "keyframes[0].motion_covariance",
                  [](Submap& s) { s.keyframes[0].motion_covariance *= 1e-310; }},
        BadSubmap{"ClosureToItself", kInvalid, "loop_closures[0]: to",
                  [](Submap& s) { s.loop_closures[0].to = s.loop_closures[0].from; }},
        BadSubmap{"ClosureElsewhere", kInvalid, "loop_closures[0]: neither end",
                  [](Submap& s) {
                    s.loop_closures[0].from.mission = s.loop_closures[0].to.mission = Mission("z");
                  }},
        BadSubmap{"ClosureIndexNegative", kInvalid, "loop_closures[0]: to.index",
                  [](Submap& s) { s.loop_closures[0].to.index = -1; }},
        BadSubmap{"ClosureCovariance", kInvalid, "loop_closures[0]: covariance",
                  [](Submap& s) { s.loop_closures[0].covariance(0, 0) = kNan; }}),
    [](const auto& info) { return info.param.name; });

TEST(MultiRobotMap, AMissionThatDoesNotBeginAtItsBeginningIsRefused) {
  MultiRobotMap map = MakeMap();
  EXPECT_EQ(map.AddSubmap(Mission("a"), MakeSubmap(1, 0, CirclePoses(3))).code(),
            absl::StatusCode::kOutOfRange);
  EXPECT_EQ(map.AddSubmap(Mission("a"), MakeSubmap(0, 3, CirclePoses(3))).code(),
            absl::StatusCode::kOutOfRange);
  EXPECT_TRUE(map.Optimise()->missions.empty());
}

}  // namespace
}  // namespace overtone
