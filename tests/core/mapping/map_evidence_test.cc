// SPDX-License-Identifier: Apache-2.0
// What ties missions together beside measured closures: landmarks, sightings of each other,
// absolute poses, scored pairs; and what weakens odometry.
#include <limits>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/geometry/trajectory_error.h"
#include "overtone/core/mapping/multi_robot_map.h"
#include "overtone/tests/core/mapping/map_test_support.h"

namespace overtone {
namespace {

const Matrix6d kOdometryNoise = Covariance(0.02, 0.004);
const Eigen::Matrix3d kSightingNoise = 0.03 * 0.03 * Eigen::Matrix3d::Identity();

double PositionError(const Rigid3d& a, const Rigid3d& b) {
  return (a.translation - b.translation).norm();
}

MultiRobotMap MakeMap(int min_consistent_closures = 3) {
  MultiRobotMapOptions options;
  options.min_consistent_closures = min_consistent_closures;
  return MultiRobotMap(options);
}

void Add(MultiRobotMap& map, const std::string& robot, const Submap& submap) {
  const absl::Status status = map.AddSubmap(Mission(robot), submap);
  ASSERT_TRUE(status.ok()) << status;
}

Eigen::Vector3d Noisy(const Eigen::Vector3d& point, std::mt19937& random) {
  std::normal_distribution<double> normal(0, 0.03);
  return point + Eigen::Vector3d(normal(random), normal(random), normal(random));
}

// Two robots on circles that overlap by half, each in its own odometry frame, among six landmarks.
class EvidenceTest : public ::testing::Test {
 protected:
  EvidenceTest() {
    const std::vector<Rigid3d> circle = CirclePoses(60);
    truth_["a"] = circle;
    for (const Rigid3d& pose : circle) truth_["b"].push_back(Planar(6, 3, 1) * pose);
    std::mt19937 random(5);
    odometry_["a"] = Drifted(truth_["a"], truth_["a"][0], kOdometryNoise, random);
    odometry_["b"] = Drifted(truth_["b"], Planar(-40, 7, 2.5), kOdometryNoise, random);
    for (int k = 0; k < 6; ++k) {
      landmarks_.push_back({8 * std::cos(k * 1.1), 10 + 7 * std::sin(k * 1.7), 0.3 * k});
    }
  }

  Submap Odometry(const std::string& robot) {
    return MakeSubmap(0, 0, odometry_[robot], kOdometryNoise);
  }

  // Every landmark within 8 m, from every third keyframe.
  void SeeLandmarks(const std::string& robot, Submap& submap) {
    for (int i = 0; i < 60; i += 3) {
      for (size_t k = 0; k < landmarks_.size(); ++k) {
        const Eigen::Vector3d point = truth_[robot][i].Inverse() * landmarks_[k];
        if (point.norm() > 8) continue;
        submap.landmark_sightings.push_back(
            {i, "tag" + std::to_string(k), Noisy(point, random_), kSightingNoise});
      }
    }
  }

  double Rmse(const SnapshotMission& mission) {
    const std::vector<Rigid3d>& truth = truth_[mission.id.robot];
    double sum = 0;
    for (size_t i = 0; i < truth.size(); ++i) {
      sum += std::pow(PositionError(mission.map_from_body[i], truth[i]), 2);
    }
    return std::sqrt(sum / static_cast<double>(truth.size()));
  }

  // Of all missions together, after one alignment: what the held first pose turns is no error.
  double TeamRmse(const MapSnapshot& snapshot) {
    std::vector<Rigid3d> estimate, truth;
    for (const SnapshotMission& mission : snapshot.missions) {
      estimate.insert(estimate.end(), mission.map_from_body.begin(), mission.map_from_body.end());
      const std::vector<Rigid3d>& of_robot = truth_[mission.id.robot];
      truth.insert(truth.end(), of_robot.begin(), of_robot.end());
    }
    return AbsoluteTrajectoryError(estimate, truth)->rmse_m;
  }

  std::mt19937 random_{9};
  std::map<std::string, std::vector<Rigid3d>> truth_, odometry_;
  std::vector<Eigen::Vector3d> landmarks_;
};

TEST_F(EvidenceTest, MissionsThatSawTheSameLandmarksBecomeOneComponent) {
  MultiRobotMap map = MakeMap();
  for (const char* robot : {"a", "b"}) {
    Submap submap = Odometry(robot);
    SeeLandmarks(robot, submap);
    Add(map, robot, submap);
  }
  map.Optimise();
  const auto snapshot = map.Optimise();
  for (const SnapshotMission& mission : snapshot->missions) {
    EXPECT_TRUE(mission.anchored) << mission.id.robot;
  }
  EXPECT_LT(TeamRmse(*snapshot), 0.1);
  EXPECT_EQ(snapshot->landmarks.size(), landmarks_.size());
  for (const SnapshotLandmark& landmark : snapshot->landmarks) {
    const int k = landmark.id.back() - '0';
    EXPECT_LT((landmark.position - landmarks_[k]).norm(), 0.5) << landmark.id;
    EXPECT_GT(landmark.sightings, 0);
  }
}

TEST_F(EvidenceTest, SightingsOfWrongLandmarksAreDemotedAndDoNoHarm) {
  MultiRobotMap map = MakeMap();
  size_t wrong = 0;
  for (const char* robot : {"a", "b"}) {
    Submap submap = Odometry(robot);
    SeeLandmarks(robot, submap);
    for (size_t k = 0; k < submap.landmark_sightings.size(); k += 6, ++wrong) {
      std::string& id = submap.landmark_sightings[k].landmark;
      id.back() = id.back() == '0' ? '3' : '0';
    }
    Add(map, robot, submap);
  }
  map.Optimise();
  const auto snapshot = map.Optimise();
  EXPECT_LT(TeamRmse(*snapshot), 0.1);
  EXPECT_GE(snapshot->sightings_demoted, 0.9 * wrong);
  EXPECT_LT(snapshot->sightings_demoted, 2 * wrong);
}

TEST_F(EvidenceTest, RobotsThatSeeEachOtherBecomeOneComponent) {
  MultiRobotMap map = MakeMap();
  Submap a = Odometry("a"), b = Odometry("b");
  for (int i = 0; i < 60; i += 4) {
    a.robot_sightings.push_back(
        {i, "b", Noisy(truth_["a"][i].Inverse() * truth_["b"][i].translation, random_),
         kSightingNoise});
  }
  Add(map, "a", a);
  EXPECT_EQ(map.Optimise()->missions.size(), 1);  // the other one is not there yet
  Add(map, "b", b);
  const auto snapshot = map.Optimise();
  EXPECT_TRUE(snapshot->missions[1].anchored);
  EXPECT_EQ(snapshot->sightings, 15);
  for (const SnapshotMission& mission : snapshot->missions) EXPECT_LT(Rmse(mission), 0.3);
}

// The stamp of a sighting falls between two keyframes of the robot that was seen.
TEST(MultiRobotMap, ARobotSeenBetweenItsKeyframesIsInterpolated) {
  MultiRobotMap map = MakeMap();
  std::vector<Rigid3d> line, arc;
  for (int i = 0; i < 40; ++i) line.push_back(Planar(i, 0, 0));
  for (int i = 0; i < 41; ++i) arc.push_back(Planar(i - 0.5, 5 * std::sin(i * 0.3), 0));
  Submap seen = MakeSubmap(0, 0, arc);
  for (Keyframe& keyframe : seen.keyframes) keyframe.stamp.ns -= 50'000'000;  // half a step early
  Submap observer = MakeSubmap(0, 0, line);
  for (int i = 0; i < 40; i += 3) {
    const Rigid3d half = Exp(0.5 * Log(arc[i].Inverse() * arc[i + 1]));
    const Eigen::Vector3d position = (arc[i] * half).translation;
    observer.robot_sightings.push_back({i, "b", line[i].Inverse() * position, kSightingNoise});
  }
  Add(map, "a", observer);
  Add(map, "b", seen);
  const auto snapshot = map.Optimise();
  EXPECT_TRUE(snapshot->missions[1].anchored);
  for (size_t i = 0; i < arc.size(); ++i) {
    EXPECT_LT(PositionError(snapshot->missions[1].map_from_body[i], arc[i]), 1e-3);
  }
}

TEST_F(EvidenceTest, ASurveyedStartPutsAMissionIntoTheMapFrame) {
  MultiRobotMap map = MakeMap();
  Submap b = Odometry("b");
  b.absolute_poses.push_back({0, truth_["b"][0], Covariance(0.01, 0.002)});
  Add(map, "a", Odometry("a"));
  EXPECT_TRUE(map.Optimise()->missions[0].anchored);
  Add(map, "b", b);
  const auto snapshot = map.Optimise();
  // Absolute poses define the map frame: a mission that nothing ties to it is no longer part of it.
  EXPECT_FALSE(snapshot->missions[0].anchored);
  EXPECT_TRUE(snapshot->missions[1].anchored);
  EXPECT_LT(PositionError(snapshot->missions[1].map_from_body[0], truth_["b"][0]), 1e-3);
}

TEST_F(EvidenceTest, PositionsAloneAnchorAMissionOnceTheyTellItsHeading) {
  MultiRobotMap map = MakeMap();
  Submap b = Odometry("b");
  Matrix6d covariance = Covariance(0.1, 100);
  for (int i = 0; i < 60; i += 5) {
    b.absolute_poses.push_back(
        {i, Rigid3d(Eigen::Quaterniond::Identity(), Noisy(truth_["b"][i].translation, random_)),
         covariance});
  }
  b.absolute_poses[4].map_from_body.translation.x() += 50;  // multipath
  Add(map, "b", b);
  const auto snapshot = map.Optimise();
  EXPECT_TRUE(snapshot->missions[0].anchored);
  EXPECT_LT(Rmse(snapshot->missions[0]), 0.2);
  EXPECT_EQ(snapshot->sightings_demoted, 1);
}

TEST_F(EvidenceTest, TheFirstTieBetweenTwoComponentsIsNotBelievedUntilThreeAgree) {
  MultiRobotMap map = MakeMap();
  Add(map, "a", Odometry("a"));
  Add(map, "b", Odometry("b"));
  const auto add_closure = [&](int i) {
    const Rigid3d a_from_b = truth_["a"][i].Inverse() * truth_["b"][i];
    ASSERT_TRUE(
        map.AddLoopClosure(MakeClosure({Mission("a"), i}, {Mission("b"), i}, a_from_b)).ok());
  };
  for (const int i : {5, 25}) {
    add_closure(i);
    const auto snapshot = map.Optimise();
    EXPECT_FALSE(snapshot->missions[1].anchored);
    EXPECT_EQ(ToString(snapshot->closures.back().verdict), "quarantined");
    EXPECT_THAT(Reason(snapshot->closures.back()), testing::HasSubstr("too few"));
  }
  add_closure(45);
  const auto snapshot = map.Optimise();
  EXPECT_TRUE(snapshot->missions[1].anchored);
  for (const ClosureRecord& record : snapshot->closures) {
    EXPECT_EQ(ToString(record.verdict), "accepted");
    EXPECT_EQ(record.since_revision, 3);
  }
}

TEST_F(EvidenceTest, PairsThatOnlyLookAlikeHoldTheirPlacesTogether) {
  MultiRobotMap map = MakeMap();
  Submap a = Odometry("a");
  Add(map, "a", a);
  const double alone = Rmse(map.Optimise()->missions[0]);
  // The circle's end is its beginning; and two wrong pairs, one of them below the score.
  ASSERT_TRUE(map.AddScoredCandidate({{Mission("a"), 59}, {Mission("a"), 0}, 0.9}).ok());
  ASSERT_TRUE(map.AddScoredCandidate({{Mission("a"), 30}, {Mission("a"), 0}, 0.8}).ok());
  ASSERT_TRUE(map.AddScoredCandidate({{Mission("a"), 20}, {Mission("a"), 0}, 0.2}).ok());
  const auto snapshot = map.Optimise();
  EXPECT_EQ(ToString(snapshot->closures[0].verdict), "accepted");
  EXPECT_EQ(ToString(snapshot->closures[1].verdict), "demoted_by_optimiser");
  EXPECT_EQ(ToString(snapshot->closures[2].verdict), "rejected_score");
  EXPECT_LT(Rmse(snapshot->missions[0]), 1.5 * alone + 0.3);
}

// One corridor is like another: what leaves its axis open counts where the map expects it, as
// weakly as it was measured, and proves nothing elsewhere.
TEST_F(EvidenceTest, AClosureWithAnOpenDirectionIsUsedOnlyWhereTheMapExpectsIt) {
  MultiRobotMap map = MakeMap();
  Add(map, "a", Odometry("a"));
  Add(map, "b", Odometry("b"));
  const auto weak = [&](const NodeId& from, const NodeId& to, const Rigid3d& from_tform_to) {
    LoopCandidate candidate = CandidateOf(MakeClosure(from, to, from_tform_to));
    candidate.proposer = LoopEvidence::kScanContext;
    candidate.registration = RegistrationFigures{true, 0.9, 0.6, 0.05, 0.1, 1};
    candidate.covariance(0, 0) = 1e8;
    return candidate;
  };
  const Rigid3d closed = truth_["a"][59].Inverse() * truth_["a"][0];
  const NodeId first = {Mission("a"), 0}, last = {Mission("a"), 59};
  ASSERT_TRUE(map.AddCandidate(weak(last, first, closed * Planar(2, 0, 0))).ok());
  ASSERT_TRUE(map.AddCandidate(weak(last, first, closed * Planar(8, 0, 0))).ok());
  for (const int i : {5, 15, 25, 35}) {
    const Rigid3d a_from_b = truth_["a"][i].Inverse() * truth_["b"][i];
    ASSERT_TRUE(map.AddCandidate(weak({Mission("a"), i}, {Mission("b"), i}, a_from_b)).ok());
  }
  const auto snapshot = map.Optimise();
  EXPECT_EQ(ToString(snapshot->closures[0].verdict), "accepted") << Reason(snapshot->closures[0]);
  EXPECT_EQ(ToString(snapshot->closures[1].verdict), "rejected_degenerate");
  EXPECT_THAT(Reason(snapshot->closures[1]), testing::HasSubstr("does not expect"));
  for (int k = 2; k < 6; ++k) EXPECT_EQ(ToString(snapshot->closures[k].verdict), "quarantined");
  EXPECT_FALSE(snapshot->missions[1].anchored);
  // The 2 m along the open direction do not pull.
  const Rigid3d end = snapshot->missions[0].map_from_body[59];
  EXPECT_NEAR((odometry_["a"][59].translation - end.translation).norm(), 0, 0.5);
}

// Odometry that turns too far at every step, and scans that say so: the path is theirs, also in
// keyframes that come later; a slipped registration is left out.
TEST_F(EvidenceTest, MotionsMeasuredASecondTimeStraightenTheOdometry) {
  MultiRobotMap map = MakeMap();
  const Matrix6d coarse = Covariance(0.1, 0.1), fine = Covariance(0.01, 0.002);
  std::vector<Rigid3d> odometry = {truth_["a"][0]};
  for (int i = 1; i < 60; ++i) {
    odometry.push_back(odometry.back() * (truth_["a"][i - 1].Inverse() * truth_["a"][i]) *
                       Planar(0, 0, 0.05));
  }
  Add(map, "a", MakeSubmap(0, 0, {odometry.begin(), odometry.begin() + 40}, coarse));
  EXPECT_GT(PositionError(map.Optimise()->missions[0].map_from_body[39], truth_["a"][39]), 5);
  const auto measure = [&](int i, const Rigid3d& slip) {
    return map.AddMotion(
        {{Mission("a"), i}, truth_["a"][i - 1].Inverse() * truth_["a"][i] * slip, fine});
  };
  for (int i = 1; i < 40; ++i) ASSERT_TRUE(measure(i, Rigid3d()).ok());
  ASSERT_TRUE(measure(20, Planar(0, 0, 3)).ok());
  EXPECT_TRUE(map.dirty());
  const auto snapshot = map.Optimise();
  EXPECT_LT(PositionError(snapshot->missions[0].map_from_body[39], truth_["a"][39]), 0.05);
  EXPECT_EQ(map.AddMotion({{Mission("a"), 0}, Rigid3d(), fine}).code(),
            absl::StatusCode::kNotFound);
  EXPECT_EQ(measure(45, Rigid3d()).code(), absl::StatusCode::kNotFound);
  MotionMeasurement bad = {{Mission("a"), 5}, Rigid3d(), -Matrix6d::Identity()};
  EXPECT_EQ(map.AddMotion(bad).code(), absl::StatusCode::kInvalidArgument);
}

// A straight drive of 20 m of which the odometry measured half in the middle third; the closure at
// its end puts the missing way where the robot said that it was blind.
TEST(MultiRobotMap, DegenerateMotionTakesUpTheErrorAlongItsDirection) {
  for (const bool flagged : {false, true}) {
    SCOPED_TRACE(flagged);
    MultiRobotMap map = MakeMap();
    std::vector<Rigid3d> odometry = {Rigid3d()};
    for (int i = 1; i < 31; ++i) {
      const bool blind = i > 10 && i <= 20;
      odometry.push_back(odometry.back() * Planar(blind ? 0.5 : 1, 0, 0));
    }
    Submap submap = MakeSubmap(0, 0, odometry, Covariance(0.05, 0.002));
    for (int i = 11; i <= 20 && flagged; ++i) {
      submap.keyframes[i].degenerate = true;
      submap.keyframes[i].degenerate_direction = Eigen::Vector3d::UnitX();
    }
    Add(map, "a", submap);
    ASSERT_TRUE(map.AddLoopClosure(MakeClosure({Mission("a"), 0}, {Mission("a"), 30},
                                               Planar(30, 0, 0), Covariance(0.05, 0.01)))
                    .ok());
    const auto& poses = map.Optimise()->missions[0].map_from_body;
    const double before = PositionError(poses[10], poses[0]);
    const double blind = PositionError(poses[20], poses[10]);
    if (flagged) {
      EXPECT_NEAR(before, 10, 0.1);
      EXPECT_NEAR(blind, 10, 0.3);
    } else {
      EXPECT_LT(blind, 8);  // spread over all, or the closure demoted
    }
  }
}

}  // namespace
}  // namespace overtone
