// SPDX-License-Identifier: Apache-2.0
// What lies beside keyframes; keyframes and closures are tested through MultiRobotMap.
#include "overtone/core/mapping/submap_check.h"

#include <cmath>
#include <string>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::StartsWith;

const MissionId kMission = {"a", "run"};

// Keyframes 4 to 6 and one of each of what may lie beside them.
Submap GoodSubmap() {
  Submap submap;
  submap.sequence = 1;
  submap.first_index = 4;
  submap.keyframes.resize(3);
  for (int i = 0; i < 3; ++i) submap.keyframes[i].stamp.ns = i;
  submap.keyframes[1].degenerate = true;
  submap.keyframes[1].degenerate_direction = {0, 1, 0};
  submap.candidates.push_back({{kMission, 5}, {{"b", "run"}, 9}, 0.5});
  submap.clouds.push_back({5});
  submap.landmark_sightings.push_back({4, "tag", {1, 2, 3}});
  submap.robot_sightings.push_back({6, "b", {1, 2, 3}});
  submap.absolute_poses.push_back({5});
  return submap;
}

TEST(CheckSubmap, OneOfEachIsTaken) {
  const absl::Status status = CheckSubmap(kMission, GoodSubmap());
  EXPECT_TRUE(status.ok()) << status;
}

TEST(CheckSubmap, EveryBadFieldIsNamed) {
  const struct {
    std::string message;
    void (*spoil)(Submap&);
  } cases[] = {
      {"keyframes[1].degenerate_direction", [](Submap& s) { s.keyframes[1].degenerate = false; }},
      {"keyframes[1].degenerate_direction",
       [](Submap& s) { s.keyframes[1].degenerate_direction *= 1.01; }},
      {"keyframes[1].degenerate_direction",
       [](Submap& s) { s.keyframes[1].degenerate_direction.x() = NAN; }},
      {"candidates[0]: to:", [](Submap& s) { s.candidates[0].to = s.candidates[0].from; }},
      {"candidates[0]: neither end", [](Submap& s) { s.candidates[0].from.mission.robot = "c"; }},
      {"candidates[0]: to.index", [](Submap& s) { s.candidates[0].to.index = -1; }},
      {"candidates[0]: score", [](Submap& s) { s.candidates[0].score = NAN; }},
      {"candidates[0]: score", [](Submap& s) { s.candidates[0].score = 1.5; }},
      {"clouds[0]: index", [](Submap& s) { s.clouds[0].index = 7; }},
      {"clouds[1]: index", [](Submap& s) { s.clouds.push_back({5}); }},
      {"landmark_sightings[0]: index", [](Submap& s) { s.landmark_sightings[0].index = 3; }},
      {"landmark_sightings[0]: landmark", [](Submap& s) { s.landmark_sightings[0].landmark = ""; }},
      {"landmark_sightings[0]: point_in_body",
       [](Submap& s) { s.landmark_sightings[0].point_in_body.z() = NAN; }},
      {"landmark_sightings[0]: covariance",
       [](Submap& s) { s.landmark_sightings[0].covariance(1, 1) = 0; }},
      {"landmark_sightings[0]: covariance",
       [](Submap& s) { s.landmark_sightings[0].covariance(0, 1) = 0.5; }},
      {"landmark_sightings[0]: covariance",  // its inverse is beyond a double
       [](Submap& s) { s.landmark_sightings[0].covariance *= 1e-110; }},
      {"robot_sightings[0]: robot", [](Submap& s) { s.robot_sightings[0].robot = "a"; }},
      {"robot_sightings[0]: robot", [](Submap& s) { s.robot_sightings[0].robot = "B"; }},
      {"robot_sightings[0]: point_in_body",
       [](Submap& s) { s.robot_sightings[0].point_in_body.x() = INFINITY; }},
      {"robot_sightings[0]: covariance",
       [](Submap& s) { s.robot_sightings[0].covariance(2, 2) = NAN; }},
      {"absolute_poses[0]: index", [](Submap& s) { s.absolute_poses[0].index = 0; }},
      {"absolute_poses[0]: map_from_body",
       [](Submap& s) { s.absolute_poses[0].map_from_body.translation.x() = NAN; }},
      {"absolute_poses[0]: covariance",
       [](Submap& s) { s.absolute_poses[0].covariance.setZero(); }},
  };
  for (const auto& bad : cases) {
    Submap submap = GoodSubmap();
    bad.spoil(submap);
    const absl::Status status = CheckSubmap(kMission, submap);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << bad.message;
    EXPECT_THAT(std::string(status.message()), StartsWith(bad.message));
  }
}

}  // namespace
}  // namespace overtone
