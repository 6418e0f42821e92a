// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/host_prediction.h"

#include <cstdint>
#include <vector>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/synchronization/aligned_rmse.h"
#include "overtone/core/synchronization/constraint_generation.h"
#include "overtone/tests/support/drifting_mission.h"

namespace overtone {
namespace {

using ::testing::Contains;

// Odometry as the host's estimate, and a chord from the server.
struct Case {
  explicit Case(int nodes) : comparison(ComparisonOf(MakeDriftingMission(nodes, 7))) {}

  HostPrediction Predict(int from, int to) const {
    const Constraint chord = ServerConstraint(comparison, from, to, ConstraintKind::kChord, 0, {});
    const auto prediction = PredictHost(comparison, OdometryRecord(), OdometryModel(), {chord});
    EXPECT_TRUE(prediction.ok()) << prediction.status();
    return *prediction;
  }

  TrajectoryComparison comparison;
};

TEST(HostPrediction, AShortMissionIsPredictedRowByRow) {
  const Case c(150);
  const HostPrediction prediction = c.Predict(3, 140);
  ASSERT_EQ(prediction.rows.size(), 150);
  EXPECT_EQ(prediction.rmse_m, AlignedRmse(prediction.poses, c.comparison.server));
  EXPECT_LT(prediction.rmse_m, AlignedRmse(c.comparison.onboard, c.comparison.server));
}

// The same odometry and the same chord, seen at all of its nodes or at every third.
TEST(HostPrediction, ALongOneIsPredictedAtSomeRowsAndNotOtherwise) {
  const Case c(5000);
  const HostPrediction prediction = c.Predict(1, 4997);  // neither is one of every third
  EXPECT_LE(prediction.rows.size(), 2003);
  for (const int row : {0, 1, 4997, 4999}) EXPECT_THAT(prediction.rows, Contains(row));
  Case thinned(2000);
  thinned.comparison = c.comparison;
  thinned.comparison.keyframe_index.clear();
  for (std::vector<Rigid3d>* poses : {&thinned.comparison.server, &thinned.comparison.onboard}) {
    *poses = prediction.Of(*poses);
  }
  int from = 0, to = 0;
  for (int i = 0; i < prediction.rows.size(); ++i) {
    thinned.comparison.keyframe_index.push_back(prediction.rows[i]);
    if (prediction.rows[i] == 1) from = i;
    if (prediction.rows[i] == 4997) to = i;
  }
  EXPECT_NEAR(thinned.Predict(from, to).rmse_m, prediction.rmse_m, 1e-9);
}

}  // namespace
}  // namespace overtone
