// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/chord_prediction.h"

#include "gtest/gtest.h"
#include "overtone/core/synchronization/aligned_rmse.h"
#include "overtone/tests/support/drifting_mission.h"

namespace overtone {
namespace {

ChordPrediction Prediction(const DriftingMission& mission) {
  return ChordPrediction(mission.truth, mission.odometry, mission.step_covariance);
}

// A straight walk of five steps whose odometry is 0.4 m long in x and 0.2 m in y, and whose first
// steps are three times as uncertain: it is there that most of the gap belongs.
TEST(ChordPrediction, SpreadsTheGapOverTheStepsByTheirVariance) {
  std::vector<Rigid3d> server, odometry;
  std::vector<Matrix6d> covariance;
  for (int i = 0; i <= 4; ++i) {
    server.emplace_back(Eigen::Quaterniond::Identity(), Eigen::Vector3d(i, 0, 0));
    odometry.emplace_back(Eigen::Quaterniond::Identity(),
                          Eigen::Vector3d(1.1 * i, 7 + 0.05 * i, 0));
    Vector6d variance = Vector6d::Constant(1e-12);  // rotations are all but known
    variance.head<3>().setConstant(i <= 2 ? 0.03 : 0.01);
    covariance.push_back(variance.asDiagonal());
  }
  const std::vector<Rigid3d> predicted =
      ChordPrediction(server, odometry, covariance).Predict({0, 4});
  // The gap is -0.4 and -0.2: 3/8 of it in each of the first two steps, 1/8 in the others.
  const double shares[] = {0, 0.375, 0.75, 0.875, 1};
  for (int i = 0; i <= 4; ++i) {
    const Eigen::Vector3d moved = predicted[i].translation - predicted[0].translation;
    EXPECT_NEAR(moved.x(), 1.1 * i - 0.4 * shares[i], 1e-6) << i;
    EXPECT_NEAR(moved.y(), 0.05 * i - 0.2 * shares[i], 1e-6) << i;
  }
}

TEST(ChordPrediction, KnotsLieOnTheServersPosesAndTheRestMovesWithTheNearestKnot) {
  const DriftingMission mission = MakeDriftingMission(80, /*seed=*/1);
  const std::vector<Rigid3d> predicted = Prediction(mission).Predict({10, 30, 60});
  const auto expect_same = [&](const std::vector<Rigid3d>& other, int from, int to) {
    const Rigid3d difference =
        (predicted[from].Inverse() * predicted[to]).Inverse() * (other[from].Inverse() * other[to]);
    EXPECT_LT(Log(difference).norm(), 1e-9) << from << " to " << to;
  };
  expect_same(mission.truth, 10, 30);
  expect_same(mission.truth, 10, 60);
  expect_same(mission.odometry, 0, 10);
  expect_same(mission.odometry, 60, 79);
}

TEST(ChordPrediction, SumsOfStretchesGiveTheRmseOfThePoses) {
  const DriftingMission mission = MakeDriftingMission(120, /*seed=*/2, 0.01, 0.001);
  const ChordPrediction prediction = Prediction(mission);
  for (const std::vector<int>& knots : {std::vector<int>{0, 119}, {5, 50, 51, 110}, {40, 80}}) {
    const double exact_m = prediction.ExactRmse(knots);
    EXPECT_NEAR(AlignedRmse(prediction.Predict(knots), mission.truth), exact_m, 1e-9);
    // The alignment to first order, and all nodes looked at.
    EXPECT_NEAR(prediction.Rmse(prediction.Of(knots, 0)), exact_m, 0.02 * exact_m);
    EXPECT_NEAR(prediction.Rmse(prediction.Of(knots, 16)), exact_m, 0.2 * exact_m);
  }
}

TEST(ChordPrediction, DoesNotDependOnTheFrames) {
  const DriftingMission mission = MakeDriftingMission(80, /*seed=*/3);
  DriftingMission moved = mission;
  const Rigid3d a(ExpSO3({0.3, -1, 2}), Eigen::Vector3d(50, -80, 9));
  const Rigid3d b(ExpSO3({-2, 0.1, 0.4}), Eigen::Vector3d(-5, 300, 1));
  for (Rigid3d& pose : moved.truth) pose = a * pose;
  for (Rigid3d& pose : moved.odometry) pose = b * pose;
  for (const std::vector<int>& knots : {std::vector<int>{}, {0, 79}, {20, 40, 60}}) {
    EXPECT_NEAR(Prediction(moved).ExactRmse(knots), Prediction(mission).ExactRmse(knots), 1e-7);
  }
}

TEST(ChordPrediction, CovarianceGrowsLikeARandomWalk) {
  const DriftingMission mission = MakeDriftingMission(50, /*seed=*/4, 0.02, 1e-9);
  const Matrix6d covariance = Prediction(mission).Covariance(10, 35);
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(covariance(axis, axis), 25 * 0.02 * 0.02, 1e-8);
  }
}

TEST(ChordPrediction, ASlipIsFarFromWhatOdometryCanHaveDrifted) {
  DriftingMission mission = MakeDriftingMission(60, /*seed=*/5);
  mission.Slip(30, Rigid3d(ExpSO3({0, 0, 0.1}), Eigen::Vector3d(0.5, 0, 0)));
  const ChordPrediction prediction = Prediction(mission);
  EXPECT_GT(prediction.GapChiSquare(29, 30), 100);
  EXPECT_LT(prediction.GapChiSquare(30, 59), 22.5);  // 99.9 %
}

}  // namespace
}  // namespace overtone
