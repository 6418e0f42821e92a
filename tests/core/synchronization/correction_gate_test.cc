// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/correction_gate.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/synchronization/aligned_rmse.h"
#include "overtone/core/synchronization/knot_selection.h"
#include "overtone/tests/support/drifting_mission.h"

namespace overtone {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

SynchronizationOptions Options() {
  SynchronizationOptions options;
  options.selection.strategy = SelectionStrategy::kKnots;
  options.selection.n = 8;
  return options;
}

// One comparison of a mission, and the batch that it asks for.
struct Case {
  TrajectoryComparison comparison;
  SelectionContext context;
  ConstraintBatch batch;
  HostPrediction prediction;
};

Case MakeCase(const DriftingMission& mission, uint64_t revision) {
  Case c;
  c.comparison = ComparisonOf(mission);
  c.comparison.revision = revision;
  c.context = {mission.odometry, mission.step_covariance, {}};
  c.batch.revision = revision;
  c.batch.add = SelectKnots(c.comparison, Options(), c.context);
  const auto prediction = PredictHost(c.comparison, OdometryRecord(), OdometryModel(), c.batch.add);
  EXPECT_TRUE(prediction.ok()) << prediction.status();
  c.prediction = *prediction;
  return c;
}

std::string Judge(CorrectionGate& gate, const Case& c) {
  return gate.Judge(c.comparison, c.context, c.batch, c.prediction);
}

TEST(CorrectionGate, LetsACorrectionPassThatIsNearerToTheServer) {
  CorrectionGate gate(Options());
  EXPECT_EQ(Judge(gate, MakeCase(MakeDriftingMission(150, 1), 1)), "");
}

TEST(CorrectionGate, HoldsBackWhatGainsNothing) {
  CorrectionGate gate(Options());
  Case c = MakeCase(MakeDriftingMission(150, 1), 1);
  c.prediction.rmse_m = AlignedRmse(c.comparison.onboard, c.comparison.server);
  EXPECT_THAT(Judge(gate, c), HasSubstr("no gain"));
  c.batch.add.clear();
  c.batch.retract = {"chord:0-2"};
  EXPECT_EQ(Judge(gate, c), "");  // to let go is no harm
}

TEST(CorrectionGate, HoldsBackWhatMovesTheRobotFurtherThanItMayBe) {
  SynchronizationOptions options = Options();
  options.gate.max_correction_m = 0.05;
  CorrectionGate gate(options);
  EXPECT_THAT(Judge(gate, MakeCase(MakeDriftingMission(150, 1), 1)), HasSubstr("at most 0.05 m"));
}

TEST(CorrectionGate, BoundsHowFarAnyPoseTurnsAndLetsPassWhatKeepsToBothBounds) {
  const Case c = MakeCase(MakeDriftingMission(150, 1), 1);
  SynchronizationOptions options = Options();
  options.gate.max_correction_rad = 0.001;
  CorrectionGate turning(options);
  EXPECT_THAT(Judge(turning, c), HasSubstr("at most inf m, 0.001 rad"));
  options.gate.max_correction_m = 100;
  options.gate.max_correction_rad = 3.2;  // no turn is larger
  CorrectionGate wide(options);
  EXPECT_EQ(Judge(wide, c), "");
}

// The server believes in a false closure: behind row 70 everything is 4 m off.
DriftingMission WithFalseClosure(DriftingMission mission) {
  for (int i = 70; i < mission.truth.size(); ++i) mission.truth[i].translation.y() += 4;
  return mission;
}

TEST(CorrectionGate, DoesNotFollowAServerThatContradictsOdometryUnlessItInsists) {
  const DriftingMission wrong = WithFalseClosure(MakeDriftingMission(150, 2));
  CorrectionGate gate(Options());
  EXPECT_THAT(Judge(gate, MakeCase(wrong, 1)), HasSubstr("contradicts odometry"));
  EXPECT_THAT(Judge(gate, MakeCase(wrong, 1)), HasSubstr("revision 1 of 3"));  // nothing new
  EXPECT_THAT(Judge(gate, MakeCase(wrong, 2)), HasSubstr("revision 2 of 3"));
  // The server has seen its mistake: it starts from nothing again.
  EXPECT_EQ(Judge(gate, MakeCase(MakeDriftingMission(150, 2), 3)), "");
  EXPECT_THAT(Judge(gate, MakeCase(wrong, 4)), HasSubstr("revision 1 of 3"));
  EXPECT_NE(Judge(gate, MakeCase(wrong, 5)), "");
  EXPECT_EQ(Judge(gate, MakeCase(wrong, 6)), "");
}

TEST(CorrectionGate, TakesBackWhatTwiceDidNotDoWhatWasPredicted) {
  CorrectionGate gate(Options());
  const Case c = MakeCase(MakeDriftingMission(150, 3), 1);
  ASSERT_EQ(Judge(gate, c), "");
  gate.Applied(c.comparison, c.batch, c.prediction);
  EXPECT_THAT(gate.Refuted(c.comparison), IsEmpty());  // it may be busy still
  EXPECT_EQ(gate.Refuted(c.comparison).size(), c.batch.add.size());
  EXPECT_THAT(gate.Refuted(c.comparison), IsEmpty());  // once is enough
  EXPECT_THAT(Judge(gate, c), HasSubstr("did not do what was predicted"));
  EXPECT_EQ(Judge(gate, c), "");
}

TEST(CorrectionGate, IsContentWhenTheHostMovedAsPredicted) {
  CorrectionGate gate(Options());
  Case c = MakeCase(MakeDriftingMission(150, 4), 1);
  gate.Applied(c.comparison, c.batch, c.prediction);
  c.comparison.onboard = c.prediction.poses;
  EXPECT_THAT(gate.Refuted(c.comparison), IsEmpty());
  EXPECT_THAT(gate.Refuted(c.comparison), IsEmpty());
}

}  // namespace
}  // namespace overtone
