// SPDX-License-Identifier: Apache-2.0
// What knots predict is what the reference onboard estimator then does.
#include "gtest/gtest.h"
#include "overtone/client/estimator/onboard_estimator.h"
#include "overtone/core/synchronization/aligned_rmse.h"
#include "overtone/core/synchronization/chord_selection.h"
#include "overtone/core/synchronization/knot_selection.h"
#include "overtone/tests/support/drifting_mission.h"

namespace overtone {
namespace {

SynchronizationOptions Options(int n) {
  SynchronizationOptions options;
  options.selection.n = n;
  options.selection.tolerance_m = 0;
  return options;
}

// RMSE to the server's estimate with the constraints applied.
double Apply(const DriftingMission& mission, const std::vector<Constraint>& constraints) {
  OnboardEstimator estimator;
  for (int i = 0; i < 2 * mission.odometry.size(); ++i) {
    // Keyframe 2 * row is the row's (ComparisonOf); those between stand still.
    const int row = i / 2;
    Rigid3d motion;
    Matrix6d covariance = 1e-12 * Matrix6d::Identity();
    if (i == 0) motion = mission.odometry[0];
    if (i > 0 && i % 2 == 0) {
      motion = mission.odometry[row - 1].Inverse() * mission.odometry[row];
      covariance = mission.step_covariance[row];
    }
    EXPECT_TRUE(estimator.AddKeyframe(i, {i}, motion, covariance).ok());
  }
  ConstraintBatch batch;
  batch.add = constraints;
  const absl::Status status = estimator.ApplyConstraints(batch);
  EXPECT_TRUE(status.ok()) << status;
  std::vector<Rigid3d> corrected;
  for (const OnboardPose& pose : estimator.Trajectory()) {
    if (pose.index % 2 == 0) corrected.push_back(pose.estimate_from_body);
  }
  return AlignedRmse(corrected, mission.truth);
}

TEST(KnotCorrection, TheEstimatorDoesWhatWasPredicted) {
  for (const int seed : {1, 2, 3}) {
    const DriftingMission mission = MakeDriftingMission(200, seed, 0.02, 0.003);
    const SelectionContext context = {mission.odometry, mission.step_covariance, {}};
    for (const int n : {1, 2, 5, 15, 50}) {
      const auto chords = SelectKnots(ComparisonOf(mission), Options(n), context);
      const double predicted_m = PredictionFor(ComparisonOf(mission), Options(n), context)
                                     .ExactRmse(KnotRows(ComparisonOf(mission), chords));
      EXPECT_NEAR(Apply(mission, chords), predicted_m, 0.05 * predicted_m)
          << "seed " << seed << ", n = " << n;
    }
  }
}

TEST(KnotCorrection, BeatsEqualChordsOnTheEstimator) {
  for (const int seed : {1, 2, 3}) {
    const DriftingMission mission = MakeDriftingMission(200, seed, 0.02, 0.003);
    const SelectionContext context = {mission.odometry, mission.step_covariance, {}};
    for (const int n : {1, 2, 5, 15, 50}) {
      const double knots_m =
          Apply(mission, SelectKnots(ComparisonOf(mission), Options(n), context));
      EXPECT_LE(knots_m, 1.02 * Apply(mission, UniformChords(ComparisonOf(mission), Options(n))))
          << "seed " << seed << ", n = " << n;
    }
  }
}

}  // namespace
}  // namespace overtone
