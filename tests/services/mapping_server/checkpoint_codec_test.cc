// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/mapping_server/checkpoint_codec.h"

#include "gtest/gtest.h"
#include "overtone/core/mapping/multi_robot_map.h"
#include "overtone/tests/core/mapping/map_test_support.h"

namespace overtone {
namespace {

// Two robots on a circle, tied by closures of which one is vetoed, with a landmark.
MultiRobotMap SmallMap() {
  MultiRobotMap map({}, 7);
  std::mt19937 random(2);
  for (const char* robot : {"a", "b"}) {
    Submap submap =
        MakeSubmap(0, 0, Drifted(CirclePoses(20), Rigid3d(), Covariance(0.02, 0.004), random));
    submap.landmark_sightings.push_back({3, "post", {1, 2, 3}, Eigen::Matrix3d::Identity()});
    submap.absolute_poses.push_back({1, CirclePoses(20)[1], Covariance(0.1, 0.1)});
    EXPECT_TRUE(map.AddSubmap(Mission(robot), submap).ok());
  }
  for (int i = 0; i < 20; i += 4) {
    EXPECT_TRUE(
        map.AddLoopClosure(MakeClosure({Mission("a"), i}, {Mission("b"), i}, Rigid3d())).ok());
  }
  map.Optimise();
  EXPECT_TRUE(map.Veto("a/m0:4>b/m0:4#0").ok());
  map.Optimise();
  return map;
}

TEST(CheckpointCodec, ACheckpointComesBackBitByBit) {
  const MapCheckpoint map = SmallMap().Checkpoint();
  const auto read = ParseCheckpoint(ToBytes({map, 17, 1002}));
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->entries, 17);
  EXPECT_EQ(read->reserved_through_revision, 1002u);
  EXPECT_EQ(read->map.revision, 2u);
  EXPECT_EQ(read->map.decisions.map_epoch, 7u);
  ASSERT_EQ(read->map.decisions.decisions.size(), 1u);
  EXPECT_EQ(read->map.decisions.decisions[0].id, "a/m0:4>b/m0:4#0");
  EXPECT_EQ(read->map.decisions.decisions[0].decision, ClosureDecision::kVetoed);
  ASSERT_EQ(read->map.missions.size(), map.missions.size());
  for (size_t m = 0; m < map.missions.size(); ++m) {
    EXPECT_EQ(read->map.missions[m].id, map.missions[m].id);
    EXPECT_EQ(read->map.missions[m].frame, map.missions[m].frame);
    ASSERT_EQ(read->map.missions[m].frame_from_body.size(), 20u);
    for (size_t i = 0; i < 20; ++i) {
      const Rigid3d &a = read->map.missions[m].frame_from_body[i],
                    &b = map.missions[m].frame_from_body[i];
      EXPECT_EQ(a.translation, b.translation);
      EXPECT_EQ(a.rotation.coeffs(), b.rotation.coeffs());
    }
  }
  ASSERT_EQ(read->map.closures.size(), 5u);
  for (size_t k = 0; k < 5; ++k) {
    EXPECT_EQ(read->map.closures[k].id, map.closures[k].id);
    EXPECT_EQ(read->map.closures[k].verdict, map.closures[k].verdict);
    EXPECT_EQ(read->map.closures[k].weight, map.closures[k].weight);
    EXPECT_EQ(read->map.closures[k].chi_square, map.closures[k].chi_square);
    EXPECT_EQ(read->map.closures[k].since_revision, map.closures[k].since_revision);
    EXPECT_EQ(read->map.closures[k].consistent_set, map.closures[k].consistent_set);
  }
  EXPECT_EQ(read->map.sighting_weights, map.sighting_weights);
  EXPECT_EQ(read->map.absolute_weights, map.absolute_weights);
  ASSERT_EQ(read->map.landmarks.size(), map.landmarks.size());
  ASSERT_GE(map.landmarks.size(), 1u);
  EXPECT_EQ(read->map.landmarks[0].id, "post");
  EXPECT_EQ(read->map.landmarks[0].position, map.landmarks[0].position);
  ASSERT_EQ(read->map.revisions.size(), 2u);
  const RevisionRecord &a = read->map.revisions[1], &b = map.revisions[1];
  EXPECT_EQ(a.revision, b.revision);
  EXPECT_EQ(a.verdicts, b.verdicts);
  EXPECT_EQ(a.dropped, b.dropped);
  EXPECT_EQ(a.cost_after, b.cost_after);
  EXPECT_EQ(a.largest_move_m, b.largest_move_m);
  EXPECT_EQ(absl::ToUnixMicros(a.made), absl::ToUnixMicros(b.made));
  EXPECT_EQ(read->map.final_cost, map.final_cost);
}

TEST(CheckpointCodec, WhatIsNoCheckpointIsAnErrorAndNoCrash) {
  std::string bytes = ToBytes({SmallMap().Checkpoint(), 17, 1002});
  EXPECT_FALSE(ParseCheckpoint("nonsense").ok());
  for (size_t cut = 0; cut < bytes.size(); cut += 97) {
    ParseCheckpoint(bytes.substr(0, cut)).status().IgnoreError();
  }
  for (size_t at = 0; at < bytes.size(); at += 13) {
    std::string other = bytes;
    other[at] ^= 0x55;
    ParseCheckpoint(other).status().IgnoreError();
  }
}

}  // namespace
}  // namespace overtone
