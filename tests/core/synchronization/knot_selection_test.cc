// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/knot_selection.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/synchronization/chord_selection.h"
#include "overtone/core/synchronization/constraint_selection.h"
#include "overtone/tests/support/drifting_mission.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

SynchronizationOptions Options(int n, double tolerance_m) {
  SynchronizationOptions options;
  options.selection.strategy = SelectionStrategy::kKnots;
  options.selection.n = n;
  options.selection.tolerance_m = tolerance_m;
  return options;
}

double PredictedRmse(const DriftingMission& mission, const std::vector<Constraint>& chords) {
  const ChordPrediction prediction(mission.truth, mission.odometry, mission.step_covariance);
  return prediction.ExactRmse(KnotRows(ComparisonOf(mission), chords));
}

TEST(SelectKnots, IsNeverWorseThanEqualChordsByItsOwnPrediction) {
  for (const int seed : {1, 2, 3}) {
    const DriftingMission mission = MakeDriftingMission(150, seed);
    const SelectionContext context = {{}, mission.step_covariance, {}};
    for (const int n : {1, 2, 5, 15, 50}) {
      const SynchronizationOptions options = Options(n, 0);
      const auto chords = SelectKnots(ComparisonOf(mission), options, context);
      EXPECT_EQ(chords.size(), n);
      EXPECT_LE(PredictedRmse(mission, chords),
                PredictedRmse(mission, UniformChords(ComparisonOf(mission), options)))
          << "seed " << seed << ", n = " << n;
    }
  }
}

TEST(SelectKnots, StopsAtTheToleranceAndNotBeforeIt) {
  const DriftingMission mission = MakeDriftingMission(150, /*seed=*/4);
  const SelectionContext context = {{}, mission.step_covariance, {}};
  const auto chords = SelectKnots(ComparisonOf(mission), Options(40, 0.1), context);
  ASSERT_GT(chords.size(), 1);
  EXPECT_LT(chords.size(), 40);
  EXPECT_LE(PredictedRmse(mission, chords), 0.1);
  const auto fewer =
      SelectKnots(ComparisonOf(mission), Options(static_cast<int>(chords.size()) - 1, 0), context);
  EXPECT_GT(PredictedRmse(mission, fewer), 0.1);
}

TEST(SelectKnots, GivesARobotThatAgreesNothing) {
  DriftingMission mission = MakeDriftingMission(200, 5, /*sigma_translation_m=*/1e-4, 1e-6);
  EXPECT_THAT(SelectConstraints(ComparisonOf(mission), Options(15, 0.01)), IsEmpty());
  EXPECT_EQ(SelectConstraints(ComparisonOf(mission), Options(15, 0)).size(), 15);
}

TEST(SelectKnots, PlacesThemByOdometryAndNotByWhatEarlierConstraintsMadeOfIt) {
  const DriftingMission mission = MakeDriftingMission(200, /*seed=*/6);
  TrajectoryComparison corrected = ComparisonOf(mission);
  corrected.onboard = mission.truth;
  EXPECT_THAT(SelectKnots(corrected, Options(8, 0.01), {}), IsEmpty());
  const SelectionContext context = {mission.odometry, mission.step_covariance, {}};
  const auto chords = SelectKnots(corrected, Options(8, 0.01), context);
  const auto expected = SelectKnots(ComparisonOf(mission), Options(8, 0.01), context);
  ASSERT_EQ(chords.size(), 8);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(chords[i].id, expected[i].id);
}

TEST(SelectKnots, KnotsInForceStayWhileTheyAreNearEnough) {
  const DriftingMission mission = MakeDriftingMission(240, /*seed=*/7);
  SelectionContext context = {{}, mission.step_covariance, {}};
  context.active = SelectKnots(ComparisonOf(mission), Options(8, 0), context);

  // The next revision: everything has moved by a few millimetres.
  DriftingMission next = mission;
  for (int i = 0; i < next.truth.size(); ++i) next.truth[i].translation.z() += 0.004 * (i % 3);
  const auto chords = SelectKnots(ComparisonOf(next), Options(8, 0.01), context);
  ASSERT_EQ(chords.size(), context.active.size());
  for (int i = 0; i < chords.size(); ++i) EXPECT_EQ(chords[i].id, context.active[i].id);

  // A budget that has shrunk is kept.
  EXPECT_EQ(SelectKnots(ComparisonOf(next), Options(5, 0.01), context).size(), 5);
}

// Knots in force are not the end of it: what moved the mission since is corrected where it is, and
// chords that are no longer needed go.
TEST(SelectKnots, KnotsInForceGoWhereTheDriftIs) {
  DriftingMission mission = MakeDriftingMission(240, /*seed=*/7);
  SelectionContext context = {{}, mission.step_covariance, {}};
  context.active = SelectKnots(ComparisonOf(mission), Options(8, 0), context);
  DriftingMission slipped = mission;
  slipped.Slip(101, Rigid3d(ExpSO3({0, 0, 0.5}), Eigen::Vector3d(2, 0, 0)));
  const double found_m =
      PredictedRmse(slipped, SelectKnots(ComparisonOf(slipped), Options(8, 0), context));
  const double anew_m = PredictedRmse(slipped, SelectKnots(ComparisonOf(slipped), Options(8, 0),
                                                           {{}, mission.step_covariance, {}}));
  EXPECT_GT(PredictedRmse(slipped, context.active), 2 * anew_m);
  EXPECT_LE(found_m, 1.21 * anew_m);

  const SynchronizationOptions lenient = Options(8, 0.4);
  const size_t enough =
      SelectKnots(ComparisonOf(mission), lenient, {{}, mission.step_covariance, {}}).size();
  ASSERT_LT(enough, 8);
  EXPECT_EQ(SelectKnots(ComparisonOf(mission), lenient, context).size(), enough);
}

TEST(SelectKnots, AChordIsStifferThanTheOdometryItBridges) {
  const DriftingMission mission = MakeDriftingMission(200, /*seed=*/8);
  const SelectionContext context = {{}, mission.step_covariance, {}};
  const SynchronizationOptions options = Options(6, 0);
  const ChordPrediction prediction = PredictionFor(ComparisonOf(mission), options, context);
  for (const Constraint& chord : SelectKnots(ComparisonOf(mission), options, context)) {
    const Vector6d odometry =
        prediction.Covariance(static_cast<int>(chord.from / 2), static_cast<int>(chord.to / 2))
            .diagonal();
    EXPECT_LE((chord.covariance.diagonal().array() / odometry.array()).maxCoeff(), 1.001e-3);
    EXPECT_LE(chord.covariance(0, 0), 0.03 * 0.03);
    EXPECT_GT(chord.covariance.diagonal().minCoeff(), 0);
  }
}

TEST(KnotRows, AreThoseOfARunOfChordsAndOfNothingElse) {
  const TrajectoryComparison comparison = ComparisonOf(MakeDriftingMission(50, 1));
  const auto chord = [](int64_t from, int64_t to) {
    Constraint constraint;
    constraint.kind = ConstraintKind::kChord;
    constraint.from = from;
    constraint.to = to;
    return constraint;
  };
  EXPECT_THAT(KnotRows(comparison, {chord(20, 60), chord(4, 20)}), ElementsAre(2, 10, 30));
  EXPECT_THAT(KnotRows(comparison, {chord(4, 20), chord(40, 60)}), IsEmpty());
  EXPECT_THAT(KnotRows(comparison, {chord(4, 21)}), IsEmpty());
  EXPECT_THAT(KnotRows(comparison, {chord(4, 200)}), IsEmpty());
  EXPECT_THAT(KnotRows(comparison, {}), IsEmpty());
  Constraint other = chord(4, 20);
  other.kind = ConstraintKind::kMid;
  EXPECT_THAT(KnotRows(comparison, {other}), IsEmpty());
}

}  // namespace
}  // namespace overtone
