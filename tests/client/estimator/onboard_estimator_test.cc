// SPDX-License-Identifier: Apache-2.0
#include "overtone/client/estimator/onboard_estimator.h"

#include <limits>
#include <thread>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;

Rigid3d Metre() { return Rigid3d(Eigen::Quaterniond::Identity(), Eigen::Vector3d::UnitX()); }

// `count` keyframes from index 5 on, a metre apart along x.
void AddStraightRun(OnboardEstimator& estimator, int count) {
  for (int i = 0; i < count; ++i) {
    ASSERT_TRUE(estimator
                    .AddKeyframe(5 + i, {1000 * i}, i == 0 ? Rigid3d() : Metre(),
                                 0.01 * Matrix6d::Identity())
                    .ok());
  }
}

Constraint Ahead(const std::string& id, int64_t from, int64_t to, double distance_m) {
  Constraint constraint;
  constraint.id = id;
  constraint.from = from;
  constraint.to = to;
  constraint.from_tform_to.translation.x() = distance_m;
  constraint.covariance = 1e-8 * Matrix6d::Identity();
  return constraint;
}

double LastX(OnboardEstimator& estimator) {
  return estimator.Trajectory().back().estimate_from_body.translation.x();
}

TEST(OnboardEstimator, AddsUpdatesAndRetractsByConstraintId) {
  OnboardEstimator estimator;
  AddStraightRun(estimator, 11);
  EXPECT_NEAR(LastX(estimator), 10, 1e-12);

  ConstraintBatch add;
  add.add = {Ahead("chord:5-15", 5, 15, 11)};
  ASSERT_TRUE(estimator.ApplyConstraints(add).ok());
  EXPECT_NEAR(LastX(estimator), 11, 1e-6);
  EXPECT_NEAR(estimator.Trajectory()[5].estimate_from_body.translation.x(), 5.5, 1e-6);
  EXPECT_EQ(estimator.Trajectory().front().estimate_from_body.translation.x(), 0);

  ConstraintBatch update;
  update.update = {Ahead("chord:5-15", 5, 15, 12)};
  ASSERT_TRUE(estimator.ApplyConstraints(update).ok());
  EXPECT_NEAR(LastX(estimator), 12, 1e-6);
  EXPECT_EQ(estimator.NumConstraints(), 1);

  ConstraintBatch retract;
  retract.retract = {"chord:5-15"};
  ASSERT_TRUE(estimator.ApplyConstraints(retract).ok());
  EXPECT_NEAR(LastX(estimator), 10, 1e-9);
  EXPECT_EQ(estimator.NumConstraints(), 0);
}

TEST(OnboardEstimator, NewKeyframesContinueFromTheCorrectedPose) {
  OnboardEstimator estimator;
  AddStraightRun(estimator, 11);
  ConstraintBatch batch;
  batch.add = {Ahead("chord:5-15", 5, 15, 11)};
  ASSERT_TRUE(estimator.ApplyConstraints(batch).ok());
  ASSERT_TRUE(estimator.AddKeyframe(16, {20000}, Metre(), Matrix6d::Identity()).ok());
  EXPECT_NEAR(LastX(estimator), 12, 1e-6);
}

TEST(OnboardEstimator, RefusesABadBatchByNameAndChangesNothing) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  OnboardEstimator estimator;
  AddStraightRun(estimator, 11);
  const auto expect_refused = [&](const ConstraintBatch& batch, const std::string& message) {
    const absl::Status status = estimator.ApplyConstraints(batch);
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << message;
    EXPECT_THAT(std::string(status.message()), HasSubstr(message));
    EXPECT_EQ(estimator.NumConstraints(), 0);
    EXPECT_NEAR(LastX(estimator), 10, 1e-12);
  };
  const auto add = [](Constraint bad) {
    ConstraintBatch batch;
    batch.add = {Ahead("good", 5, 15, 11), std::move(bad)};
    return batch;
  };
  expect_refused(add(Ahead("a", 4, 10, 1)), "constraint a: no keyframe 4");
  expect_refused(add(Ahead("b", 5, 16, 1)), "constraint b: no keyframe 16");
  expect_refused(add(Ahead("c", 7, 7, 1)), "constraint c: both ends");
  expect_refused(add(Ahead("d", 5, 9, nan)), "constraint d: transform");
  Constraint indefinite = Ahead("e", 5, 9, 4);
  indefinite.covariance(0, 0) = -1;
  expect_refused(add(indefinite), "constraint e: covariance");
  Constraint zero_quaternion = Ahead("f", 5, 9, 4);
  zero_quaternion.from_tform_to.rotation.coeffs().setZero();
  expect_refused(add(zero_quaternion), "constraint f: transform");
  ConstraintBatch update;
  update.update = {Ahead("g", 5, 9, 4)};
  expect_refused(update, "constraint g: not held");
  ConstraintBatch retract;
  retract.retract = {"h"};
  expect_refused(retract, "constraint h: not held");
}

TEST(OnboardEstimator, RefusesABadKeyframeByNameAndChangesNothing) {
  OnboardEstimator estimator;
  AddStraightRun(estimator, 3);
  const Matrix6d identity = Matrix6d::Identity();
  const auto expect_refused = [&](const absl::Status& status, const std::string& message) {
    EXPECT_EQ(status.code(), absl::StatusCode::kInvalidArgument) << message;
    EXPECT_THAT(std::string(status.message()), HasSubstr(message));
    EXPECT_EQ(estimator.Trajectory().size(), 3);
  };
  expect_refused(estimator.AddKeyframe(9, {9000}, Metre(), identity), "expected index 8");
  expect_refused(estimator.AddKeyframe(8, {2000}, Metre(), identity), "stamp");
  expect_refused(estimator.AddKeyframe(8, {9000}, Metre(), Matrix6d::Zero()), "covariance");
  Rigid3d infinite = Metre();
  infinite.translation.y() = std::numeric_limits<double>::infinity();
  expect_refused(estimator.AddKeyframe(8, {9000}, infinite, identity), "keyframe 8: transform");
}

TEST(OnboardEstimator, EmptyTrajectoriesAndBatchesAreFine) {
  OnboardEstimator estimator;
  EXPECT_TRUE(estimator.ApplyConstraints(ConstraintBatch()).ok());
  EXPECT_TRUE(estimator.Trajectory().empty());
  AddStraightRun(estimator, 1);
  EXPECT_TRUE(estimator.ApplyConstraints(ConstraintBatch()).ok());
  EXPECT_EQ(estimator.Trajectory().size(), 1);
}

TEST(OnboardEstimator, OdometryAndConstraintsMayComeFromTwoThreads) {
  OnboardEstimator estimator;
  AddStraightRun(estimator, 11);
  std::thread odometry([&estimator] {
    for (int i = 11; i < 500; ++i) {
      EXPECT_TRUE(estimator.AddKeyframe(5 + i, {1000 * i}, Metre(), Matrix6d::Identity()).ok());
    }
  });
  for (int k = 0; k < 20; ++k) {
    ConstraintBatch batch;
    batch.add = {Ahead("chord:5-15", 5, 15, 10 + 0.1 * k)};
    EXPECT_TRUE(estimator.ApplyConstraints(batch).ok());
    EXPECT_GE(estimator.Trajectory().size(), 11);
  }
  odometry.join();
  EXPECT_NEAR(LastX(estimator), 499 + 1.9, 1e-5);
}

}  // namespace
}  // namespace overtone
