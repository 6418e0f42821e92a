// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/odometry_record.h"

#include "gtest/gtest.h"
#include "overtone/tests/support/drifting_mission.h"

namespace overtone {
namespace {

std::vector<NodePose> Nodes(const std::vector<Rigid3d>& poses, const std::vector<int>& indices) {
  std::vector<NodePose> nodes;
  for (const int index : indices) nodes.push_back({index, {}, poses[index]});
  return nodes;
}

std::vector<Keyframe> Keyframes(const DriftingMission& mission, int begin, int end) {
  std::vector<Keyframe> keyframes;
  for (int i = begin; i < end; ++i) {
    Keyframe keyframe;
    keyframe.mission_from_body = mission.odometry[i];
    keyframe.motion_covariance = mission.step_covariance[i];
    keyframes.push_back(keyframe);
  }
  return keyframes;
}

void ExpectMotion(const OdometryChain& chain, int node, const Rigid3d& from, const Rigid3d& to) {
  const Rigid3d motion = chain.poses[node - 1].Inverse() * chain.poses[node];
  EXPECT_LT(Log(motion.Inverse() * (from.Inverse() * to)).norm(), 1e-6) << "node " << node;
}

TEST(OdometryRecord, KnowsWhatWasUploadedWhateverTheEstimateIsNow) {
  const DriftingMission mission = MakeDriftingMission(30, /*seed=*/1, 0.02, 1e-6);
  OdometryRecord record;
  record.AddKeyframes(0, Keyframes(mission, 0, 12));
  record.AddKeyframes(12, Keyframes(mission, 12, 30));
  const OdometryChain chain = record.Along(Nodes(mission.truth, {2, 3, 20}), OdometryModel());
  ExpectMotion(chain, 1, mission.odometry[2], mission.odometry[3]);
  ExpectMotion(chain, 2, mission.odometry[3], mission.odometry[20]);
  EXPECT_NEAR(chain.step_covariance[1](0, 0), 0.02 * 0.02, 1e-9);
  EXPECT_NEAR(chain.step_covariance[2](0, 0), 17 * 0.02 * 0.02, 1e-6);
}

TEST(OdometryRecord, RemembersStepsAsTheyWereFirstSeen) {
  const DriftingMission mission = MakeDriftingMission(30, /*seed=*/2);
  OdometryRecord record;
  record.Observe(Nodes(mission.odometry, {0, 5, 10}), OdometryModel());
  // Corrected meanwhile; the step from 10 to 12 is new.
  std::vector<NodePose> nodes = Nodes(mission.truth, {0, 5, 10});
  nodes.push_back(
      {12, {}, mission.truth[10] * (mission.odometry[10].Inverse() * mission.odometry[12])});
  record.Observe(nodes, OdometryModel());
  const OdometryChain chain = record.Along(nodes, OdometryModel());
  ExpectMotion(chain, 1, mission.odometry[0], mission.odometry[5]);
  ExpectMotion(chain, 2, mission.odometry[5], mission.odometry[10]);
  ExpectMotion(chain, 3, mission.odometry[10], mission.odometry[12]);
}

// After a restart only what comes next is uploaded by this process.
TEST(OdometryRecord, TakesTheEstimatesWordForWhatItHasNeverSeen) {
  const DriftingMission mission = MakeDriftingMission(30, /*seed=*/3);
  OdometryRecord record;
  record.AddKeyframes(20, Keyframes(mission, 20, 30));
  const OdometryChain chain = record.Along(Nodes(mission.truth, {0, 10, 20, 25}), OdometryModel());
  ExpectMotion(chain, 1, mission.truth[0], mission.truth[10]);
  ExpectMotion(chain, 2, mission.truth[10], mission.truth[20]);
  ExpectMotion(chain, 3, mission.odometry[20], mission.odometry[25]);
  EXPECT_GT(chain.step_covariance[1](0, 0), 0);
}

}  // namespace
}  // namespace overtone
