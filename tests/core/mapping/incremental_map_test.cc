// SPDX-License-Identifier: Apache-2.0
// A map that is optimised after every submap, only where it has to be, against solving all of it at
// once.
#include <atomic>

#include "Eigen/LU"
#include "gtest/gtest.h"
#include "overtone/core/estimation/pose_graph_optimizer.h"
#include "overtone/tests/support/full_graph.h"
#include "overtone/tests/support/street_team.h"

namespace overtone {
namespace {

constexpr int kRobots = 4;
constexpr int kKeyframes = 3000;

double BestCost(const MapSnapshot& snapshot) {
  PoseGraphOptimizerOptions options;
  options.function_tolerance = 1e-12;
  const auto best = OptimizePoseGraph(FullGraph(snapshot, snapshot), options);
  return best.ok() ? best->final_cost : -1;
}

// What the snapshot's own poses cost, keyframe by keyframe.
double CostOfPoses(const MapSnapshot& snapshot) {
  PoseGraphOptimizerOptions options;
  options.max_iterations = 0;
  const auto result = OptimizePoseGraph(FullGraph(snapshot, snapshot), options);
  return result.ok() ? result->final_cost : -1;
}

TEST(IncrementalMap, CostsAfterEverySubmapAsSolvingTheWholeToAMillionth) {
  MultiRobotMap map((MultiRobotMapOptions()));
  StreetTeam team(kRobots, kKeyframes);
  for (int cycle = 0; team.NumKeyframes() < kKeyframes; ++cycle) {
    team.AddSubmap(map);
    const auto snapshot = map.Optimise();
    if (cycle % 10 != 9) continue;
    const double best = BestCost(*snapshot);
    EXPECT_NEAR(CostOfPoses(*snapshot), best, 1e-6 * best) << cycle;
    EXPECT_NEAR(snapshot->final_cost, best, 1e-6 * best) << cycle;
    for (const ClosureRecord& record : snapshot->closures) {
      EXPECT_TRUE(InUse(record.verdict) || record.verdict == ClosureVerdict::kQuarantined)
          << record.id;
    }
  }
}

TEST(IncrementalMap, ASubmapOfNothingButOdometryChangesNoPoseThatWasThere) {
  MultiRobotMap map((MultiRobotMapOptions()));
  StreetTeam team(kRobots, kKeyframes);
  while (team.NumKeyframes() < 1000) team.AddSubmap(map);
  map.Optimise();
  const auto before = map.Optimise();
  const SnapshotMission& longest = before->missions[0];
  const auto next = static_cast<int64_t>(longest.keyframes.size());
  Submap submap = MakeSubmap(static_cast<int64_t>(longest.submap_starts.size()), next,
                             {longest.keyframes.back().mission_from_body * Planar(1, 0, 0)});
  ASSERT_TRUE(map.AddSubmap(longest.id, submap).ok());
  const auto after = map.Optimise();
  for (size_t m = 0; m < before->missions.size(); ++m) {
    for (size_t i = 0; i < before->missions[m].map_from_body.size(); ++i) {
      EXPECT_EQ(before->missions[m].map_from_body[i].translation,
                after->missions[m].map_from_body[i].translation)
          << m << " " << i;
    }
  }
  EXPECT_EQ(after->missions[0].map_from_body.size(), next + 1);
}

TEST(IncrementalMap, SnapshotsShareTheKeyframesAndEachHasItsOwnPoses) {
  MultiRobotMap map((MultiRobotMapOptions()));
  StreetTeam team(kRobots, kKeyframes);
  while (team.NumKeyframes() < 400) team.AddSubmap(map);
  const auto first = map.Optimise();
  const std::vector<Rigid3d> poses = first->missions[0].map_from_body;
  while (team.NumKeyframes() < 1600) team.AddSubmap(map);
  const auto second = map.Optimise();
  const size_t size = first->missions[0].keyframes.size();
  EXPECT_EQ(&first->missions[0].keyframes[size - 1], &second->missions[0].keyframes[size - 1]);
  EXPECT_GT(second->missions[0].keyframes.size(), size);
  for (size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(first->missions[0].map_from_body[i].translation, poses[i].translation);
  }
}

// After it the map goes on as if nothing had been tried.
TEST(IncrementalMap, AnOptimisationThatIsGivenUpLeavesTheMapAsItWas) {
  MultiRobotMap map((MultiRobotMapOptions())), other((MultiRobotMapOptions()));
  StreetTeam team(kRobots, kKeyframes), same_team(kRobots, kKeyframes);
  while (team.NumKeyframes() < 1000) {
    team.AddSubmap(map);
    same_team.AddSubmap(other);
    if (team.NumKeyframes() == 500) {
      map.Optimise();
      other.Optimise();
    }
  }
  const MapCheckpoint before = map.Checkpoint();
  const std::atomic<bool> give_up{true};
  EXPECT_EQ(map.Optimise(&give_up), nullptr);
  EXPECT_TRUE(map.dirty());
  EXPECT_EQ(map.revision(), before.revision);
  const MapCheckpoint after = map.Checkpoint();
  for (size_t m = 0; m < before.missions.size(); ++m) {
    EXPECT_EQ(before.missions[m].frame, after.missions[m].frame);
    for (size_t i = 0; i < before.missions[m].frame_from_body.size(); ++i) {
      EXPECT_EQ(before.missions[m].frame_from_body[i].translation,
                after.missions[m].frame_from_body[i].translation);
    }
  }
  const auto snapshot = map.Optimise(), expected = other.Optimise();
  EXPECT_EQ(snapshot->revision, expected->revision);
  EXPECT_NEAR(snapshot->final_cost, expected->final_cost, 1e-6 * expected->final_cost);
  for (size_t k = 0; k < snapshot->closures.size(); ++k) {
    EXPECT_EQ(snapshot->closures[k].verdict, expected->closures[k].verdict);
  }
}

}  // namespace
}  // namespace overtone
