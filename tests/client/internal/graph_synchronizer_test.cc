// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/internal/graph_synchronizer.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/tests/support/fake_host.h"
#include "overtone/tests/support/straight_mission.h"

namespace overtone {
namespace {

constexpr int kNumNodes = 60;

class GraphSynchronizerTest : public testing::Test {
 protected:
  void SetTrajectory(double bend_m) {
    absl::MutexLock lock(&host_.mutex);
    host_.trajectory = BentTrajectory(kNumNodes, bend_m);
  }
  void SetAnswer(const absl::Status& answer) {
    absl::MutexLock lock(&host_.mutex);
    host_.answer = answer;
  }
  void SetThrows(bool throws) {
    absl::MutexLock lock(&host_.mutex);
    host_.throws = throws;
  }
  int NumBatches() {
    absl::MutexLock lock(&host_.mutex);
    return static_cast<int>(host_.batches.size());
  }

  FakeHost host_;
  GraphSynchronizer synchronizer_{TestMission(), SynchronizationOptions(), &host_};
};

TEST_F(GraphSynchronizerTest, AgreementCallsForNothing) {
  SetTrajectory(/*bend_m=*/0);
  const auto report = synchronizer_.Synchronize(StraightGraph(kNumNodes, 1));
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_EQ(report->comparison.keyframe_index.size(), kNumNodes);
  EXPECT_TRUE(report->batch.empty());
  EXPECT_EQ(NumBatches(), 0);
}

TEST_F(GraphSynchronizerTest, DriftGivesOneBatchOfTheServersRelativePoses) {
  SetTrajectory(/*bend_m=*/0.5);
  const auto report = synchronizer_.Synchronize(StraightGraph(kNumNodes, /*revision=*/7));
  ASSERT_TRUE(report.ok()) << report.status();
  ASSERT_FALSE(report->batch.add.empty());
  EXPECT_EQ(NumBatches(), 1);
  EXPECT_EQ(report->batch.revision, 7);
  EXPECT_TRUE(report->host_status.ok());
  EXPECT_GT(report->compare_ms, 0);
  for (const Constraint& constraint : report->batch.add) {
    const double along = static_cast<double>(constraint.to - constraint.from);
    EXPECT_NEAR((constraint.from_tform_to.translation - Eigen::Vector3d(along, 0, 0)).norm(), 0,
                1e-9);
  }
}

// The newest keyframe is bent away by 0.5 m, and the first stays where it is.
TEST_F(GraphSynchronizerTest, ABatchSaysHowSlowlyTheNewestPoseMayBeMoved) {
  SynchronizationOptions options;
  options.blend.max_velocity_m_per_s = 0.25;
  options.blend.max_turn_rad_per_s = 100;
  GraphSynchronizer synchronizer(TestMission(), options, &host_);
  SetTrajectory(/*bend_m=*/0.5);
  const auto report = synchronizer.Synchronize(StraightGraph(kNumNodes, 1));
  ASSERT_TRUE(report.ok()) << report.status();
  ASSERT_FALSE(report->batch.empty());
  EXPECT_NEAR(report->batch.newest_move_m, 0.5, 0.1);
  EXPECT_NEAR(report->batch.blend_s, report->batch.newest_move_m / 0.25, 1e-9);
}

// Ten keyframes that the server does not have yet turn about the last that it has.
TEST_F(GraphSynchronizerTest, WhatTheServerDoesNotHaveYetMovesAlong) {
  SetTrajectory(/*bend_m=*/0.5);
  const auto report = synchronizer_.Synchronize(StraightGraph(kNumNodes - 10, 1));
  ASSERT_TRUE(report.ok()) << report.status();
  ASSERT_FALSE(report->batch.empty());
  EXPECT_NEAR(report->batch.newest_move_m, 0.5, 0.2);
  EXPECT_GT(report->batch.blend_s, 0);
}

TEST_F(GraphSynchronizerTest, WhatTheHostAppliedIsNotOfferedAgain) {
  SetTrajectory(0.5);
  ASSERT_TRUE(synchronizer_.Synchronize(StraightGraph(kNumNodes, 1)).ok());
  const auto report = synchronizer_.Synchronize(StraightGraph(kNumNodes, 2));
  ASSERT_TRUE(report.ok());
  EXPECT_TRUE(report->batch.empty());
  EXPECT_EQ(NumBatches(), 1);
}

TEST_F(GraphSynchronizerTest, WhatTheHostRefusedIsOfferedAnew) {
  SetTrajectory(0.5);
  SetAnswer(absl::UnavailableError("busy"));
  const auto refused = synchronizer_.Synchronize(StraightGraph(kNumNodes, 1));
  ASSERT_TRUE(refused.ok());
  EXPECT_EQ(refused->host_status.code(), absl::StatusCode::kUnavailable);

  SetAnswer(absl::OkStatus());
  const auto applied = synchronizer_.Synchronize(StraightGraph(kNumNodes, 1));
  ASSERT_TRUE(applied.ok());
  ASSERT_FALSE(refused->batch.add.empty());
  ASSERT_EQ(applied->batch.add.size(), refused->batch.add.size());
  for (int i = 0; i < applied->batch.add.size(); ++i) {
    EXPECT_EQ(applied->batch.add[i].id, refused->batch.add[i].id);
  }
}

TEST_F(GraphSynchronizerTest, WhatDidNotDoWhatWasPredictedIsTakenBack) {
  SetTrajectory(0.5);  // and there it stays, whatever the host is asked to apply
  const auto first = synchronizer_.Synchronize(StraightGraph(kNumNodes, 1));
  ASSERT_TRUE(first.ok());
  ASSERT_FALSE(first->batch.add.empty());
  EXPECT_GT(first->rmse_before_m, 0.01);
  EXPECT_LT(first->predicted_rmse_m, first->rmse_before_m);
  EXPECT_EQ(first->held_back, "");
  ASSERT_TRUE(synchronizer_.Synchronize(StraightGraph(kNumNodes, 2)).ok());
  const auto third = synchronizer_.Synchronize(StraightGraph(kNumNodes, 3));
  ASSERT_TRUE(third.ok());
  EXPECT_EQ(third->batch.retract.size(), first->batch.add.size());
  EXPECT_THAT(third->held_back, testing::HasSubstr("did not do what was predicted"));
}

TEST_F(GraphSynchronizerTest, AServerThatContradictsOdometryIsNotFollowedAtOnce) {
  SetTrajectory(/*bend_m=*/0);
  MapGraph wrong = StraightGraph(kNumNodes, 1);
  for (int i = 30; i < kNumNodes; ++i) {
    wrong.missions[0].nodes[i].map_from_body.translation.y() += 5;
  }
  const auto report = synchronizer_.Synchronize(wrong);
  ASSERT_TRUE(report.ok()) << report.status();
  EXPECT_TRUE(report->batch.empty());
  EXPECT_THAT(report->held_back, testing::HasSubstr("contradicts odometry"));
  EXPECT_EQ(NumBatches(), 0);
}

TEST_F(GraphSynchronizerTest, AThrowingHostIsAHostThatRefuses) {
  SetThrows(true);
  const auto status = synchronizer_.Synchronize(StraightGraph(kNumNodes, 1)).status();
  EXPECT_EQ(status.code(), absl::StatusCode::kInternal);
  EXPECT_THAT(std::string(status.message()),
              testing::HasSubstr("HostEstimator::Trajectory threw: the host is out"));
}

TEST_F(GraphSynchronizerTest, AnExceptionFromApplyConstraintsCountsAsRefusal) {
  class ThrowingHost : public HostEstimator {
   public:
    std::vector<OnboardPose> Trajectory() override { return BentTrajectory(kNumNodes, 0.5); }
    absl::Status ApplyConstraints(const ConstraintBatch& /*batch*/) override {
      if (calls_++ == 0) throw 42;  // NOLINT: hosts do such things
      return absl::OkStatus();
    }

   private:
    int calls_ = 0;
  } host;
  GraphSynchronizer synchronizer(TestMission(), SynchronizationOptions(), &host);
  const auto refused = synchronizer.Synchronize(StraightGraph(kNumNodes, 1));
  ASSERT_TRUE(refused.ok());
  EXPECT_EQ(refused->host_status.code(), absl::StatusCode::kInternal);
  const auto applied = synchronizer.Synchronize(StraightGraph(kNumNodes, 1));
  ASSERT_TRUE(applied.ok());
  EXPECT_TRUE(applied->host_status.ok());
  EXPECT_EQ(applied->batch.add.size(), refused->batch.add.size());
}

TEST_F(GraphSynchronizerTest, AMissionTheServerDoesNotKnowOrTooFewCommonNodesAreErrors) {
  SetTrajectory(0.5);
  MapGraph graph = StraightGraph(kNumNodes, 1);
  graph.missions[0].id.mission = "another_run";
  EXPECT_EQ(synchronizer_.Synchronize(graph).status().code(), absl::StatusCode::kNotFound);
  EXPECT_EQ(synchronizer_.Synchronize(StraightGraph(2, 1)).status().code(),
            absl::StatusCode::kFailedPrecondition);
  EXPECT_EQ(NumBatches(), 0);
}

}  // namespace
}  // namespace overtone
