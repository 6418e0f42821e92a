// SPDX-License-Identifier: Apache-2.0
// A map that is restored from its checkpoint goes on as if it had never stopped.
#include "overtone/core/mapping/map_checkpoint.h"

#include <functional>
#include <memory>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/mapping/multi_robot_map.h"
#include "overtone/tests/core/mapping/map_test_support.h"

namespace overtone {
namespace {

using Entry = std::function<absl::Status(MultiRobotMap&)>;

const std::vector<Rigid3d> kTruth = CirclePoses(40);
const Matrix6d kDrift = Covariance(0.02, 0.004);

Submap Half(const std::vector<Rigid3d>& odometry, int half) {
  const auto begin = odometry.begin() + 20 * half;
  Submap submap = MakeSubmap(half, 20 * half, {begin, begin + 20}, kDrift);
  for (const int i : {3, 11, 17}) {
    LandmarkSighting sighting;
    sighting.index = submap.first_index + i;
    sighting.landmark = half == 0 ? "post" : "door";
    sighting.point_in_body =
        kTruth[sighting.index].Inverse() * Eigen::Vector3d(4, half == 0 ? 2 : 9, 0);
    sighting.covariance = 1e-4 * Eigen::Matrix3d::Identity();
    submap.landmark_sightings.push_back(sighting);
  }
  return submap;
}

// Two robots around one circle: closures between them, one of them wrong, landmarks that both see,
// a refined motion and, from the start of robot b, a surveyed pose.
std::vector<Entry> Entries() {
  std::vector<Entry> entries;
  std::mt19937 random(5);
  const auto a = Drifted(kTruth, Rigid3d(), kDrift, random);
  const auto b = Drifted(kTruth, Planar(3, 1, 0.4), kDrift, random);
  for (const int half : {0, 1}) {
    Submap of_b = Half(b, half);
    if (half == 0) of_b.absolute_poses.push_back({2, kTruth[2], Covariance(0.05, 0.01)});
    entries.push_back([submap = Half(a, half)](MultiRobotMap& map) {
      return map.AddSubmap(Mission("a"), submap);
    });
    entries.push_back([of_b](MultiRobotMap& map) { return map.AddSubmap(Mission("b"), of_b); });
    entries.push_back([a, half](MultiRobotMap& map) {
      const int i = 20 * half + 7;
      return map.AddMotion({{Mission("a"), i}, kTruth[i - 1].Inverse() * kTruth[i], kDrift});
    });
    for (int i = 20 * half; i < 20 * half + 20; i += 4) {
      const Rigid3d wrong = i == 24 ? Planar(2, 2, 1) : Rigid3d();
      entries.push_back([i, wrong](MultiRobotMap& map) {
        return map.AddLoopClosure(MakeClosure({Mission("a"), i}, {Mission("b"), i}, wrong));
      });
    }
  }
  return entries;
}

void Feed(MultiRobotMap& map, const std::vector<Entry>& entries, size_t from, size_t to) {
  for (size_t k = from; k < to; ++k) {
    const absl::Status status = entries[k](map);
    ASSERT_TRUE(status.ok()) << k << ": " << status;
  }
}

void ExpectSame(const MapSnapshot& a, const MapSnapshot& b, double tolerance) {
  EXPECT_EQ(a.revision, b.revision);
  EXPECT_EQ(a.map_epoch, b.map_epoch);
  EXPECT_EQ(a.sightings, b.sightings);
  EXPECT_EQ(a.sightings_demoted, b.sightings_demoted);
  EXPECT_NEAR(a.final_cost, b.final_cost, tolerance * (1 + a.final_cost));
  ASSERT_EQ(a.missions.size(), b.missions.size());
  for (size_t m = 0; m < a.missions.size(); ++m) {
    EXPECT_EQ(a.missions[m].id, b.missions[m].id);
    EXPECT_EQ(a.missions[m].component, b.missions[m].component);
    EXPECT_EQ(a.missions[m].anchored, b.missions[m].anchored);
    EXPECT_EQ(a.missions[m].submap_starts, b.missions[m].submap_starts);
    ASSERT_EQ(a.missions[m].map_from_body.size(), b.missions[m].map_from_body.size());
    for (size_t i = 0; i < a.missions[m].map_from_body.size(); ++i) {
      const Rigid3d difference =
          a.missions[m].map_from_body[i].Inverse() * b.missions[m].map_from_body[i];
      EXPECT_LE(Log(difference).norm(), tolerance) << m << ' ' << i;
    }
  }
  ASSERT_EQ(a.closures.size(), b.closures.size());
  for (size_t k = 0; k < a.closures.size(); ++k) {
    EXPECT_EQ(a.closures[k].id, b.closures[k].id);
    EXPECT_EQ(ToString(a.closures[k].verdict), ToString(b.closures[k].verdict)) << k;
    EXPECT_EQ(a.closures[k].since_revision, b.closures[k].since_revision) << k;
    EXPECT_NEAR(a.closures[k].weight, b.closures[k].weight, tolerance) << k;
  }
  ASSERT_EQ(a.landmarks.size(), b.landmarks.size());
  for (size_t i = 0; i < a.landmarks.size(); ++i) {
    EXPECT_EQ(a.landmarks[i].id, b.landmarks[i].id);
    EXPECT_EQ(a.landmarks[i].sightings, b.landmarks[i].sightings);
    EXPECT_LE((a.landmarks[i].position - b.landmarks[i].position).norm(), tolerance);
  }
}

class MapCheckpointTest : public ::testing::TestWithParam<size_t> {
 protected:
  const std::vector<Entry> entries_ = Entries();
};

TEST_P(MapCheckpointTest, TheRestoredMapIsTheSameAndGoesOnTheSame) {
  const size_t stop = GetParam();
  MultiRobotMap lasting({}, 7);
  Feed(lasting, entries_, 0, stop / 2);
  lasting.Optimise();
  Feed(lasting, entries_, stop / 2, stop);
  const auto before = lasting.Optimise();
  const MapCheckpoint checkpoint = lasting.Checkpoint();

  MultiRobotMap restored({}, 1);
  Feed(restored, entries_, 0, stop);
  const auto after = restored.Restore(checkpoint);
  ASSERT_TRUE(after.ok()) << after.status();
  ExpectSame(*before, **after, 0);
  EXPECT_FALSE(restored.dirty());
  EXPECT_EQ(restored.history().records().size(), 2u);

  Feed(lasting, entries_, stop, entries_.size());
  Feed(restored, entries_, stop, entries_.size());
  // Not to the last bit: the lasting map keeps stretches of odometry as they were relaxed, the
  // other has relaxed them anew, and each stops where what is left gains next to nothing: 10 um
  // here, of the 2 mm to which poses are published.
  ExpectSame(*lasting.Optimise(), *restored.Optimise(), 1e-5);
  EXPECT_EQ(lasting.history().records().back().accepted,
            restored.history().records().back().accepted);
}

// After a's first submap; amid the first closures; between the two halves; amid the last closures.
INSTANTIATE_TEST_SUITE_P(Everywhere, MapCheckpointTest, ::testing::Values(2, 6, 9, 14));

TEST_F(MapCheckpointTest, TheWrongClosureIsStillDemotedAfterARestart) {
  MultiRobotMap map({}, 7);
  Feed(map, entries_, 0, entries_.size());
  const auto before = map.Optimise();
  MultiRobotMap restored({}, 7);
  Feed(restored, entries_, 0, entries_.size());
  const auto after = *restored.Restore(map.Checkpoint());
  int unused = 0;
  for (const ClosureRecord& record : after->closures) unused += !InUse(record.verdict);
  EXPECT_EQ(unused, 1);
}

TEST_F(MapCheckpointTest, ADecisionMadeAfterTheCheckpointIsSetOnTop) {
  MultiRobotMap map({}, 7);
  Feed(map, entries_, 0, 8);
  map.Optimise();
  const MapCheckpoint checkpoint = map.Checkpoint();
  ASSERT_TRUE(map.Veto("a/m0:4>b/m0:4#0").ok());
  ASSERT_TRUE(map.Force("a/m0:8>b/m0:8#0").ok());

  MultiRobotMap restored({}, 7);
  Feed(restored, entries_, 0, 8);
  ASSERT_TRUE(restored.Restore(checkpoint).ok());
  restored.SetDecisions(map.Decisions());
  EXPECT_TRUE(restored.dirty());
  ExpectSame(*map.Optimise(), *restored.Optimise(), 1e-9);
}

TEST_F(MapCheckpointTest, ARolledBackMapKeepsItsEpochAndItsWayBack) {
  MultiRobotMap map({}, 7);
  Feed(map, entries_, 0, 5);
  map.Optimise();
  Feed(map, entries_, 5, 9);
  map.Optimise();
  ASSERT_TRUE(map.RollBack(1, 8).ok());
  map.Optimise();
  MultiRobotMap restored({}, 1);
  Feed(restored, entries_, 0, 9);
  const auto snapshot = restored.Restore(map.Checkpoint());
  ASSERT_TRUE(snapshot.ok());
  EXPECT_EQ((*snapshot)->map_epoch, 8u);
  EXPECT_EQ(restored.Decisions().decisions.size(), map.Decisions().decisions.size());
  EXPECT_GT(restored.Decisions().decisions.size(), 0u);
  EXPECT_EQ(restored.RollBack(1, 9).status().code(), absl::StatusCode::kNotFound);  // other epoch
  EXPECT_TRUE(restored.RollBack(3, 9).ok());
}

TEST_F(MapCheckpointTest, ACheckpointOfAnotherMapIsRefusedAndChangesNothing) {
  MultiRobotMap map({}, 7);
  Feed(map, entries_, 0, 9);
  map.Optimise();
  const MapCheckpoint good = map.Checkpoint();
  std::vector<MapCheckpoint> bad(7, good);
  bad[0].missions.pop_back();
  bad[1].missions[0].frame_from_body.pop_back();
  bad[2].missions[1].frame = 2;
  bad[3].closures[2].id = "another";
  bad[4].sighting_weights.push_back(1);
  bad[5].absolute_weights.clear();
  bad[6].landmarks[0].frame = -2;
  MultiRobotMap restored({}, 1);
  Feed(restored, entries_, 0, 9);
  for (size_t k = 0; k < bad.size(); ++k) {
    EXPECT_EQ(restored.Restore(bad[k]).status().code(), absl::StatusCode::kFailedPrecondition) << k;
  }
  EXPECT_TRUE(restored.Restore(good).ok());
}

TEST_F(MapCheckpointTest, RevisionsThatMayHaveBeenSeenAreNotGivenOutAgain) {
  MultiRobotMap map({}, 7);
  Feed(map, entries_, 0, 2);
  map.Optimise();
  map.StartAfter(41);
  EXPECT_TRUE(map.dirty());
  EXPECT_EQ(map.Optimise()->revision, 42u);
  map.StartAfter(3);
  EXPECT_FALSE(map.dirty());
}

}  // namespace
}  // namespace overtone
