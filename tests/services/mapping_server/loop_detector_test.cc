// SPDX-License-Identifier: Apache-2.0
// Two robots drive through one hall; what they saw comes as encoded clouds, as from the store.
#include "overtone/services/mapping_server/loop_detector.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "absl/synchronization/mutex.h"
#include "absl/time/clock.h"
#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/graph/point_cloud_codec.h"
#include "overtone/core/mapping/loop_closure.h"
#include "overtone/tests/services/mapping_server/blob_shelf.h"
#include "overtone/tests/support/simulated_scans.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::SizeIs;
using Blob = std::shared_ptr<const std::string>;

const MissionId kAnna = {"anna", "run"};
const MissionId kBert = {"bert", "run"};

struct Mission {
  MissionId id;
  std::vector<Rigid3d> world_from_body;
  std::vector<Blob> blobs;  // of each keyframe

  Rigid3d FromTo(int64_t from, const Mission& other, int64_t to) const {
    return world_from_body[from].Inverse() * other.world_from_body[to];
  }

  Submap AsSubmap() const {
    Submap submap;
    for (size_t i = 0; i < world_from_body.size(); ++i) {
      Keyframe keyframe;
      keyframe.stamp = {static_cast<int64_t>(i) + 1};
      keyframe.mission_from_body = world_from_body[0].Inverse() * world_from_body[i];
      submap.keyframes.push_back(keyframe);
      submap.clouds.push_back({static_cast<int64_t>(i), nullptr, std::string(32, 'c'), 100});
    }
    return submap;
  }
};

// Turned by half a turn, HallWorld looks much like itself: what stands along its one long wall and
// in a corner sets that right.
PatchWorld OddHall() {
  PatchWorld world = HallWorld();
  AddBox({-5, -11, 3}, {14, 6, 6}, 0.1, world);
  AddBox({15, 3, 3}, {6, 10, 6}, 0.2, world);
  return world;
}

// `keyframes` of them from (x, y) on, 2 m apart, straight along `yaw`.
Mission Drive(const MissionId& id, double x, double y, double yaw, int keyframes, uint64_t seed) {
  static const PatchWorld hall = OddHall();
  Scanner scanner;
  scanner.num_rings = 16;
  scanner.num_columns = 360;
  Random random(seed);
  Mission mission;
  mission.id = id;
  for (int i = 0; i < keyframes; ++i) {
    mission.world_from_body.push_back(
        StandingAt(x + 2 * i * std::cos(yaw), y + 2 * i * std::sin(yaw), yaw));
    const PointCloud cloud = Scan(hall, mission.world_from_body.back(), scanner, random);
    mission.blobs.push_back(std::make_shared<const std::string>(*EncodePointCloud(cloud, {})));
  }
  return mission;
}

Mission Anna() { return Drive(kAnna, -14, 0.5, 0, 12, 1); }
Mission Bert() { return Drive(kBert, 8, -0.5, M_PI, 12, 2); }  // the way back

class LoopDetectorTest : public ::testing::Test {
 protected:
  void Start(const LoopDetectorOptions& options = {}) {
    ASSERT_TRUE(options.Validate().ok());
    detector_ = std::make_unique<LoopDetector>(
        options, [this](const std::string& sha256) { return blobs_.Get(sha256); },
        LoopDetector::Sink{[this](SearchResult search) {
                             absl::MutexLock lock(&mutex_);
                             searched_.push_back(search.node);
                             for (LoopCandidate& candidate : search.candidates) {
                               found_.push_back(std::move(candidate));
                             }
                           },
                           [this](const RefinedMotion& motion) {
                             absl::MutexLock lock(&mutex_);
                             motions_.push_back(motion.measurement);
                           },
                           [this](LoopCandidate candidate) {
                             absl::MutexLock lock(&mutex_);
                             found_.push_back(std::move(candidate));
                           },
                           [this](const ScoredCandidate& pair) {
                             absl::MutexLock lock(&mutex_);
                             pairs_.push_back(pair);
                           }});
  }
  // A detector that proposes nothing by itself.
  void StartWithoutProposals() {
    LoopDetectorOptions options;
    options.proposer.min_similarity = 1;
    Start(options);
  }

  void AddCloud(const Mission& mission, int64_t index) {
    detector_->AddCloud({mission.id, index}, blobs_.Put(mission.blobs[index]));
  }
  void AddAll(const Mission& mission) {
    detector_->AddSubmap(mission.id, mission.AsSubmap());
    for (size_t i = 0; i < mission.blobs.size(); ++i) AddCloud(mission, i);
  }
  // Anna's and Bert's submaps, Bert's with a pair that looks alike, and none of their clouds.
  void AddSubmapsWithPair(int64_t anna_index, int64_t bert_index) {
    detector_->AddSubmap(kAnna, anna_.AsSubmap());
    Submap submap = bert_.AsSubmap();
    submap.candidates.push_back({{kAnna, anna_index}, {kBert, bert_index}, 0.7});
    detector_->AddSubmap(kBert, submap);
  }

  std::vector<LoopCandidate> Found() {
    const absl::Time deadline = absl::Now() + absl::Seconds(60);
    while (detector_->backlog() > 0 && absl::Now() < deadline) std::this_thread::yield();
    EXPECT_EQ(detector_->backlog(), 0);
    absl::MutexLock lock(&mutex_);
    return found_;
  }
  std::vector<ScoredCandidate> Pairs() {
    absl::MutexLock lock(&mutex_);
    return pairs_;
  }

  static void ExpectRight(const LoopCandidate& candidate, const Rigid3d& truth) {
    const Rigid3d error = truth.Inverse() * candidate.from_tform_to;
    EXPECT_LT(error.translation.norm(), 0.1) << ToString(candidate.from);
    EXPECT_LT(LogSO3(error.rotation).norm(), 0.02) << ToString(candidate.to);
  }

  const Mission anna_ = Anna(), bert_ = Bert();
  BlobShelf blobs_;
  absl::Mutex mutex_;
  std::vector<NodeId> searched_ ABSL_GUARDED_BY(mutex_);
  std::vector<LoopCandidate> found_ ABSL_GUARDED_BY(mutex_);
  std::vector<ScoredCandidate> pairs_ ABSL_GUARDED_BY(mutex_);
  std::vector<MotionMeasurement> motions_ ABSL_GUARDED_BY(mutex_);
  std::unique_ptr<LoopDetector> detector_;  // last: its threads use the rest
};

// Wheels that slip 10 cm and 5 degrees at every step of 30 cm.
TEST_F(LoopDetectorTest, PlanarScansMeasureAnewWhatWheelsMeasuredBadly) {
  StartWithoutProposals();
  const PatchWorld room = RoomWorld();
  Random random(4);
  Mission mission;
  mission.id = kAnna;
  Submap submap;
  Rigid3d odometry;
  const Rigid3d slip(ExpSO3({0, 0, 0.09}), {0.1, 0, 0});
  for (int i = 0; i < 8; ++i) {
    mission.world_from_body.push_back(StandingAt(-1 + 0.3 * i, 0.2, 0.05 * i));
    const PointCloud cloud = Scan(room, mission.world_from_body.back(), PlanarScanner(), random);
    mission.blobs.push_back(std::make_shared<const std::string>(*EncodePointCloud(cloud, {})));
    if (i > 0) odometry = odometry * mission.FromTo(i - 1, mission, i) * slip;
    Keyframe& keyframe = submap.keyframes.emplace_back();
    keyframe.stamp = {i + 1};
    keyframe.mission_from_body = odometry;
    submap.clouds.push_back({i, nullptr, std::string(32, 'c'), 100});
  }
  detector_->AddSubmap(kAnna, submap);
  for (int i = 0; i < 8; ++i) AddCloud(mission, i);
  Found();
  absl::MutexLock lock(&mutex_);
  ASSERT_THAT(motions_, SizeIs(7));
  for (int i = 1; i < 8; ++i) {
    EXPECT_EQ(motions_[i - 1].to, (NodeId{kAnna, i}));  // in the order in which they came
    const Rigid3d error =
        mission.FromTo(i - 1, mission, i).Inverse() * motions_[i - 1].previous_from_this;
    EXPECT_LT(error.translation.norm(), 0.03) << i;
    EXPECT_LT(LogSO3(error.rotation).norm(), 0.02) << i;
  }
}

TEST_F(LoopDetectorTest, TwoMissionsThroughOneHallAreTiedRightly) {
  Start();
  AddAll(anna_);
  AddAll(bert_);
  int taken = 0;
  for (const LoopCandidate& candidate : Found()) {
    EXPECT_EQ(candidate.proposer, LoopEvidence::kScanContext);
    EXPECT_GE(candidate.score, candidate.score_threshold);
    ASSERT_TRUE(candidate.measured);
    ASSERT_TRUE(candidate.registration.has_value());
    if (JudgeFigures(candidate) != ClosureVerdict::kPending) continue;
    const Mission& from = candidate.from.mission == kAnna ? anna_ : bert_;
    const Mission& to = candidate.to.mission == kAnna ? anna_ : bert_;
    ExpectRight(candidate, from.FromTo(candidate.from.index, to, candidate.to.index));
    taken += from.id != to.id;
  }
  EXPECT_GE(taken, 6);
  EXPECT_THAT(Pairs(), IsEmpty());
}

TEST_F(LoopDetectorTest, EveryCloudIsReportedOnceWithAllThatWasFoundAtIt) {
  Start();
  AddAll(anna_);
  AddAll(bert_);
  const size_t found = Found().size();
  absl::MutexLock lock(&mutex_);
  EXPECT_THAT(searched_, SizeIs(24));
  std::sort(searched_.begin(), searched_.end());
  EXPECT_EQ(std::unique(searched_.begin(), searched_.end()), searched_.end());
  EXPECT_GT(found, 0u);
}

// Of Anna's keyframes 0 to 9 were searched before the restart, and one pair was measured.
TEST_F(LoopDetectorTest, WhatWasFoundBeforeARestartIsNotLookedForAgain) {
  Start();
  detector_->BeginReplay();
  Submap of_anna = anna_.AsSubmap();
  of_anna.candidates.push_back({{kAnna, 0}, {kAnna, 9}, 0.7});
  of_anna.candidates.push_back({{kAnna, 1}, {kAnna, 11}, 0.7});
  detector_->AddSubmap(kAnna, of_anna);
  for (int i = 0; i < 10; ++i) detector_->NoteSearch({kAnna, i});
  detector_->NotePair({kAnna, 0}, {kAnna, 9});
  for (int i = 0; i < 12; ++i) AddCloud(anna_, i);
  EXPECT_EQ(detector_->backlog(), 0);  // nothing moves before the end of the replay
  detector_->EndReplay();
  for (const LoopCandidate& candidate : Found()) {
    EXPECT_NE(candidate.to, (NodeId{kAnna, 9}));
  }
  {
    absl::MutexLock lock(&mutex_);
    EXPECT_THAT(searched_, ElementsAre(NodeId{kAnna, 10}, NodeId{kAnna, 11}));
    const auto robots = std::count_if(found_.begin(), found_.end(), [](const auto& candidate) {
      return candidate.proposer == LoopEvidence::kRobotScore;
    });
    EXPECT_EQ(robots, 1);
    found_.clear();
  }
  AddAll(bert_);
  const std::vector<LoopCandidate> later = Found();
  // The places known from before are found again.
  EXPECT_TRUE(std::any_of(later.begin(), later.end(), [](const LoopCandidate& candidate) {
    return candidate.from.mission == kAnna && candidate.from.index < 10;
  }));
}

TEST_F(LoopDetectorTest, AMotionRefinedBeforeARestartIsNotRefinedAgain) {
  StartWithoutProposals();
  const PatchWorld room = RoomWorld();
  Random random(4);
  Mission mission;
  mission.id = kAnna;
  for (int i = 0; i < 4; ++i) {
    mission.world_from_body.push_back(StandingAt(-1 + 0.3 * i, 0.2, 0));
    const PointCloud cloud = Scan(room, mission.world_from_body.back(), PlanarScanner(), random);
    mission.blobs.push_back(std::make_shared<const std::string>(*EncodePointCloud(cloud, {})));
  }
  detector_->BeginReplay();
  detector_->AddSubmap(kAnna, mission.AsSubmap());
  detector_->NoteMotion({{{kAnna, 1}, mission.FromTo(0, mission, 1)}, true});
  for (int i = 0; i < 4; ++i) AddCloud(mission, i);
  detector_->EndReplay();
  Found();
  absl::MutexLock lock(&mutex_);
  ASSERT_THAT(motions_, SizeIs(2));
  EXPECT_EQ(motions_[0].to, (NodeId{kAnna, 2}));
  EXPECT_EQ(motions_[1].to, (NodeId{kAnna, 3}));
}

TEST_F(LoopDetectorTest, ThePlaceThatLooksMostAlikeIsKnownEvenIfItWasNotProposed) {
  StartWithoutProposals();
  AddAll(anna_);
  AddAll(bert_);
  EXPECT_THAT(Found(), IsEmpty());
  const auto nearest = detector_->MostSimilar({kBert, 6});
  ASSERT_TRUE(nearest.has_value());
  EXPECT_LT(nearest->score, 1);
  EXPECT_GT(nearest->score, 0.3);
  EXPECT_EQ(nearest->score_threshold, 1);
  EXPECT_EQ(nearest->to, (NodeId{kBert, 6}));
  EXPECT_FALSE(detector_->MostSimilar({kBert, 99}).has_value());
}

TEST_F(LoopDetectorTest, AScoredPairWithoutCloudsIsDeliveredAtOnce) {
  Start();
  Submap submap = bert_.AsSubmap();
  submap.clouds.clear();
  submap.candidates.push_back({{kAnna, 3}, {kBert, 7}, 0.7});
  detector_->AddSubmap(kBert, submap);
  ASSERT_THAT(Pairs(), SizeIs(1));
  EXPECT_EQ(Pairs()[0].from, (NodeId{kAnna, 3}));
  EXPECT_EQ(Pairs()[0].to, (NodeId{kBert, 7}));
  EXPECT_EQ(Pairs()[0].score, 0.7);
  EXPECT_THAT(Found(), IsEmpty());
}

// The pair says nothing of the heading, so the two look the same way here.
TEST_F(LoopDetectorTest, AScoredPairIsMeasuredWhenBothItsCloudsAreThere) {
  StartWithoutProposals();
  const Mission carl = Drive({"carl", "run"}, -13, 1.2, 0.1, 3, 3);
  detector_->AddSubmap(kAnna, anna_.AsSubmap());
  Submap submap = carl.AsSubmap();
  submap.candidates.push_back({{kAnna, 1}, {carl.id, 1}, 0.7});
  detector_->AddSubmap(carl.id, submap);
  AddCloud(anna_, 1);
  AddCloud(carl, 2);
  EXPECT_THAT(Found(), IsEmpty());
  EXPECT_THAT(Pairs(), IsEmpty());
  AddCloud(carl, 1);
  const std::vector<LoopCandidate> found = Found();
  ASSERT_THAT(found, SizeIs(1));
  EXPECT_EQ(found[0].proposer, LoopEvidence::kRobotScore);
  EXPECT_EQ(found[0].score, 0.7);
  EXPECT_EQ(JudgeFigures(found[0]), ClosureVerdict::kPending);
  ExpectRight(found[0], anna_.FromTo(1, carl, 1));
  EXPECT_THAT(Pairs(), IsEmpty());
}

TEST_F(LoopDetectorTest, APairWhoseCloudsCameEarlierIsMeasuredToo) {
  StartWithoutProposals();
  AddAll(anna_);
  Submap later = anna_.AsSubmap();
  later.first_index = 12;
  later.candidates.push_back({{kAnna, 2}, {kAnna, 3}, 0.9});
  detector_->AddSubmap(kAnna, later);
  ASSERT_THAT(Found(), SizeIs(1));
  ExpectRight(Found()[0], anna_.FromTo(2, anna_, 3));
}

TEST_F(LoopDetectorTest, APairWhoseCloudIsGoneIsDeliveredAsItIs) {
  StartWithoutProposals();
  AddSubmapsWithPair(3, 8);
  AddCloud(anna_, 3);
  detector_->CloudGone({kBert, 7});  // another one's
  EXPECT_THAT(Pairs(), IsEmpty());
  detector_->CloudGone({kBert, 8});
  ASSERT_THAT(Pairs(), SizeIs(1));
  EXPECT_EQ(Pairs()[0].to, (NodeId{kBert, 8}));
  EXPECT_EQ(Pairs()[0].score, 0.7);
  // Later pairs with it do not wait either, and it is not delivered twice.
  Submap later = anna_.AsSubmap();
  later.first_index = 12;
  later.candidates.push_back({{kAnna, 4}, {kBert, 8}, 0.8});
  detector_->AddSubmap(kAnna, later);
  ASSERT_THAT(Pairs(), SizeIs(2));
  EXPECT_EQ(Pairs()[1].score, 0.8);
  AddCloud(bert_, 8);
  EXPECT_THAT(Found(), IsEmpty());
  EXPECT_THAT(Pairs(), SizeIs(2));
}

TEST_F(LoopDetectorTest, APairWhoseCloudCannotBeReadIsDeliveredAsItIs) {
  StartWithoutProposals();
  AddSubmapsWithPair(3, 8);
  AddCloud(anna_, 3);
  detector_->AddCloud({kBert, 8}, blobs_.Put(std::make_shared<const std::string>("no cloud")));
  EXPECT_THAT(Found(), IsEmpty());
  ASSERT_THAT(Pairs(), SizeIs(1));
  EXPECT_EQ(Pairs()[0].score, 0.7);
}

TEST_F(LoopDetectorTest, DisabledItLooksAtNoClouds) {
  LoopDetectorOptions options;
  options.enabled = false;
  Start(options);
  AddSubmapsWithPair(3, 8);
  EXPECT_THAT(Pairs(), SizeIs(1));
  for (int i = 0; i < 12; ++i) {
    AddCloud(anna_, i);
    AddCloud(bert_, i);
  }
  detector_->CloudGone({kBert, 8});
  EXPECT_EQ(detector_->backlog(), 0);
  EXPECT_THAT(Found(), IsEmpty());
  EXPECT_THAT(Pairs(), SizeIs(1));
  EXPECT_FALSE(detector_->MostSimilar({kBert, 6}).has_value());
}

}  // namespace
}  // namespace overtone
