// SPDX-License-Identifier: Apache-2.0
// A wrong loop closure on its whole way: it bends the map, the robot follows the map, an operator
// takes it back, and so does the robot.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "gtest/gtest.h"
#include "overtone/client/estimator/onboard_estimator.h"
#include "overtone/client/mapping_client.h"
#include "overtone/tests/services/mapping_server/server_fixture.h"

namespace overtone {
namespace {

using Stub = v1::MapAdminService::Stub;

const MissionId kAnna = {"anna", "run1"};
constexpr int kKeyframes = 100;
constexpr int kPerSubmap = 10;
constexpr absl::Duration kPatience = absl::Seconds(30);
const char kWrong[] = "anna/run1:99>anna/run1:0#0";

// The reference estimator, and what it has been asked to hold.
class RecordingEstimator final : public OnboardEstimator {
 public:
  absl::Status ApplyConstraints(const ConstraintBatch& batch) override {
    const absl::Status status = OnboardEstimator::ApplyConstraints(batch);
    if (!status.ok()) return status;
    for (const Constraint& constraint : batch.add) held[constraint.id] = constraint;
    for (const Constraint& constraint : batch.update) held[constraint.id] = constraint;
    for (const std::string& id : batch.retract) held.erase(id);
    return status;
  }

  std::map<std::string, Constraint> held;  // read between two calls of Synchronize
};

class OperatorVetoTest : public testing::ServerTest,
                         public ::testing::WithParamInterface<SelectionStrategy> {
 protected:
  void SetUp() override {
    StartServer();
    MappingClientOptions options;
    options.server = server_->address();
    options.map = "mine";
    options.mission = kAnna;
    options.min_time_between_comparisons = absl::InfiniteDuration();
    options.synchronization.selection.strategy = GetParam();
    // It would hold the bend back; here the robot is to be bent.
    options.synchronization.gate.enabled = false;
    auto client = MappingClient::Create(options, &robot_);
    ASSERT_TRUE(client.ok()) << client.status();
    client_ = *std::move(client);
    Drive();
    odometry_ = Trajectory();
    ASSERT_EQ(odometry_.size(), size_t{kKeyframes});
  }

  // A robot whose odometry is good, and a closure that is metres off.
  void Drive() {
    Matrix6d covariance = 1e-6 * Matrix6d::Identity();
    covariance.topLeftCorner<3, 3>() *= 25;  // 5 mm, 1 mrad
    Rigid3d last;
    for (int64_t i = 0; i < kKeyframes / kPerSubmap; ++i) {
      Submap submap = testing::MakeSubmap(i, i * kPerSubmap, kPerSubmap);
      for (int64_t k = 0; k < kPerSubmap; ++k) {
        Keyframe& keyframe = submap.keyframes[k];
        keyframe.motion_covariance = covariance;
        const absl::Status added =
            robot_.AddKeyframe(i * kPerSubmap + k, keyframe.stamp,
                               last.Inverse() * keyframe.mission_from_body, covariance);
        ASSERT_TRUE(added.ok()) << added;
        last = keyframe.mission_from_body;
      }
      ASSERT_TRUE(client_->AddSubmap(submap).ok());
    }
    LoopClosure wrong;
    wrong.from = {kAnna, kKeyframes - 1};
    wrong.to = {kAnna, 0};
    wrong.from_tform_to =
        last.Inverse() * Rigid3d(ExpSO3(Eigen::Vector3d(0, 0, 0.3)), Eigen::Vector3d(0, 5, 1));
    wrong.covariance = covariance;
    ASSERT_TRUE(client_->AddLoopClosures({wrong}).ok());
    const absl::Status status = client_->WaitUntilAcknowledged(kPatience);
    ASSERT_TRUE(status.ok()) << status;
  }

  std::vector<Rigid3d> Trajectory() {
    std::vector<Rigid3d> poses;
    for (const OnboardPose& pose : robot_.Trajectory()) poses.push_back(pose.estimate_from_body);
    return poses;
  }

  // Compares as often as a robot would while the server stands still.
  void SynchronizeWithNewest() {
    const uint64_t revision = Settle("mine").revision();
    ASSERT_TRUE(client_->WaitForKeyframe(kKeyframes - 1, revision, kPatience).ok());
    for (int round = 0; round < 5; ++round) {
      const auto report = client_->Synchronize();
      ASSERT_TRUE(report.ok()) << report.status();
      ASSERT_TRUE(report->host_status.ok()) << report->host_status;
    }
  }

  // Of the keyframe that lies furthest from where odometry has it.
  double BentByM() {
    const std::vector<Rigid3d> poses = Trajectory();
    double largest = 0;
    for (size_t i = 0; i < poses.size(); ++i) {
      largest = std::max(largest, (poses[i].translation - odometry_[i].translation).norm());
    }
    return largest;
  }

  // Of all constraints in force, how far off the truth, which is the odometry.
  double WorstConstraintM() const {
    double worst = 0;
    for (const auto& [id, constraint] : robot_.held) {
      const Rigid3d truth = odometry_[constraint.from].Inverse() * odometry_[constraint.to];
      worst = std::max(worst, (truth.Inverse() * constraint.from_tform_to).translation.norm());
    }
    return worst;
  }

  void ForceTheWrongOne() {
    v1::ForceLoopClosureRequest request;
    request.set_map("mine");
    request.set_id(kWrong);
    Call<v1::ForceLoopClosureResponse>(&Stub::ForceLoopClosure, request);
    SynchronizeWithNewest();
    EXPECT_GT(robot_.NumConstraints(), 0);
    EXPECT_GT(BentByM(), 1);
    EXPECT_GT(WorstConstraintM(), 0.2);
    std::printf("bent by %.3f m with %d constraints\n", BentByM(), robot_.NumConstraints());
  }
  void ExpectStraightAgain() {
    std::printf("back within %.4f m; constraints within %.4f m\n", BentByM(), WorstConstraintM());
    EXPECT_LT(BentByM(), 0.1);
    EXPECT_LT(WorstConstraintM(), 0.05);  // min_translation_change_m and some
    EXPECT_EQ(robot_.NumConstraints(), static_cast<int>(robot_.held.size()));
  }

  RecordingEstimator robot_;
  std::unique_ptr<MappingClient> client_;
  std::vector<Rigid3d> odometry_;
};

TEST_P(OperatorVetoTest, TheServerItselfKeepsTheWrongClosureOut) {
  SynchronizeWithNewest();
  EXPECT_LT(BentByM(), 0.05);
}

TEST_P(OperatorVetoTest, WhatCameFromAForcedClosureIsTakenBackAfterAVeto) {
  ForceTheWrongOne();
  v1::VetoLoopClosureRequest request;
  request.set_map("mine");
  request.set_id(kWrong);
  Call<v1::VetoLoopClosureResponse>(&Stub::VetoLoopClosure, request);
  SynchronizeWithNewest();
  ExpectStraightAgain();
}

TEST_P(OperatorVetoTest, WhatCameFromAForcedClosureIsTakenBackAfterARollBack) {
  const uint64_t before = Settle("mine").revision();
  ForceTheWrongOne();
  v1::RollBackRequest request;
  request.set_map("mine");
  request.set_revision(before);
  const auto response = Call<v1::RollBackResponse>(&Stub::RollBack, request);
  EXPECT_EQ(response.vetoed(), 1);
  SynchronizeWithNewest();
  EXPECT_EQ(client_->Graph()->map_epoch, response.map_epoch());
  ExpectStraightAgain();
}

INSTANTIATE_TEST_SUITE_P(Strategies, OperatorVetoTest,
                         ::testing::Values(SelectionStrategy::kTopN, SelectionStrategy::kUniform));

}  // namespace
}  // namespace overtone
