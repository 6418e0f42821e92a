// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/knot_search.h"

#include <algorithm>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/synchronization/knot_parts.h"
#include "overtone/core/synchronization/knot_table.h"
#include "overtone/core/synchronization/knot_update.h"
#include "overtone/tests/support/drifting_mission.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;

ChordPrediction Prediction(const DriftingMission& mission) {
  return ChordPrediction(mission.truth, mission.odometry, mission.step_covariance);
}

// The best of all sets of `count` knots, by trying them.
KnotSet BestOfAll(const ChordPrediction& prediction, int count) {
  KnotSet best;
  std::vector<bool> taken(prediction.size(), false);
  std::fill(taken.begin(), taken.begin() + count, true);
  do {
    std::vector<int> knots;
    for (int i = 0; i < prediction.size(); ++i) {
      if (taken[i]) knots.push_back(i);
    }
    const double rmse_m = prediction.ExactRmse(knots);
    if (best.knots.empty() || rmse_m < best.rmse_m) best = {knots, rmse_m};
  } while (std::prev_permutation(taken.begin(), taken.end()));
  return best;
}

TEST(KnotTable, FindsTheLeastSumOfSquares) {
  const ChordPrediction prediction = Prediction(MakeDriftingMission(14, /*seed=*/1));
  std::vector<int> rows(14);
  for (int i = 0; i < 14; ++i) rows[i] = i;
  const auto best = KnotTable(prediction, rows, 0).Best(13, Vector6d::Zero());
  ASSERT_EQ(best.size(), 13);
  for (int chords = 1; chords <= 13; ++chords) {
    ASSERT_EQ(best[chords - 1].size(), chords + 1);
    const double found = prediction.Of(best[chords - 1], 0).squares;
    std::vector<bool> taken(14, false);
    std::fill(taken.begin(), taken.begin() + chords + 1, true);
    double least = found;
    do {
      std::vector<int> knots;
      for (int i = 0; i < 14; ++i) {
        if (taken[i]) knots.push_back(i);
      }
      least = std::min(least, prediction.Of(knots, 0).squares);
    } while (std::prev_permutation(taken.begin(), taken.end()));
    EXPECT_NEAR(found, least, 1e-12) << chords << " chords";
  }
}

TEST(KnotSearch, ComesNearTheBestOfAllSetsOfKnots) {
  for (const int seed : {1, 2, 3, 4, 5}) {
    const ChordPrediction prediction = Prediction(MakeDriftingMission(18, seed, 0.02, 0.002));
    const KnotSearch search(prediction, KnotSearchOptions());
    for (const int chords : {1, 2, 3}) {
      const double best_m = BestOfAll(prediction, chords + 1).rmse_m;
      EXPECT_LE(search.BestOf(chords, {}).rmse_m, 1.06 * best_m)
          << "seed " << seed << ", " << chords << " chords";
    }
  }
}

TEST(KnotSearch, IsNeverWorseThanWhatItStartsFrom) {
  const ChordPrediction prediction = Prediction(MakeDriftingMission(400, /*seed=*/6));
  KnotSearchOptions coarse;  // so that the table knows little
  coarse.max_candidates = 4;
  coarse.samples_per_stretch = 1;
  const KnotSearch search(prediction, coarse);
  const std::vector<int> start = {0, 80, 160, 240, 320, 399};
  EXPECT_LE(search.BestOf(5, {start}).rmse_m, prediction.ExactRmse(start));
}

TEST(KnotSearch, PutsAChordAcrossASlip) {
  DriftingMission mission = MakeDriftingMission(1000, /*seed=*/7, 1e-4, 1e-5);
  mission.Slip(613, Rigid3d(ExpSO3({0, 0, 0.2}), Eigen::Vector3d(0, 1, 0)));
  const ChordPrediction prediction = Prediction(mission);
  EXPECT_THAT(KnotSearch(prediction, KnotSearchOptions()).BestOf(1, {}).knots,
              ElementsAre(612, 613));
}

TEST(CandidateKnots, HoldBothEndsAndTheLargestSteps) {
  DriftingMission mission = MakeDriftingMission(1000, /*seed=*/8);
  mission.Slip(613, Rigid3d(ExpSO3({0, 0, 0.2}), Eigen::Vector3d(0, 1, 0)));
  const std::vector<int> candidates = CandidateKnots(Prediction(mission), 60);
  EXPECT_LE(candidates.size(), 60);
  EXPECT_GT(candidates.size(), 50);
  for (const int row : {0, 612, 613, 999}) {
    EXPECT_TRUE(std::binary_search(candidates.begin(), candidates.end(), row)) << row;
  }
  EXPECT_EQ(CandidateKnots(Prediction(MakeDriftingMission(20, 1)), 60).size(), 20);
}

// What is kept stretch by stretch is what a sum over all of them gives, whatever was changed.
TEST(KnotParts, AreTheWholeAfterEveryChange) {
  const ChordPrediction prediction = Prediction(MakeDriftingMission(200, /*seed=*/10));
  const auto rmse_of = [&](const std::vector<int>& knots) {
    return prediction.Rmse(prediction.Of(knots, 0));
  };
  KnotParts parts(prediction, {20, 60, 61, 150}, 0);
  EXPECT_NEAR(parts.rmse_m(), rmse_of({20, 60, 61, 150}), 1e-12);
  for (const int row : {3, 40, 100, 199}) {
    std::vector<int> more = parts.knots();
    more.insert(std::lower_bound(more.begin(), more.end(), row), row);
    EXPECT_NEAR(parts.RmseWith(row), rmse_of(more), 1e-12) << row;
  }
  EXPECT_FALSE(parts.Move(1, 61));
  EXPECT_FALSE(parts.Move(3, 200));
  int num_moved = 0;
  for (const int row : {70, 90, 110, 130}) num_moved += parts.Move(2, row);
  EXPECT_GT(num_moved, 0);
  EXPECT_NEAR(parts.rmse_m(), rmse_of(parts.knots()), 1e-12);
  for (const int k : {3, 0, 1}) {
    parts.Remove(k);
    EXPECT_NEAR(parts.rmse_m(), rmse_of(parts.knots()), 1e-12) << k;
  }
  EXPECT_EQ(parts.knots().size(), 1);
}

TEST(KnotSearch, TakesAWastedKnotToWhereItHelps) {
  const ChordPrediction prediction = Prediction(MakeDriftingMission(300, /*seed=*/9));
  const KnotSearch search(prediction, KnotSearchOptions());
  const KnotSet best = search.BestOf(7, {});
  EXPECT_LE(search.Improved(best.knots).rmse_m, best.rmse_m);
  std::vector<int> wasteful = best.knots;
  wasteful[3] = wasteful[2] + 1;
  EXPECT_LE(search.Improved(wasteful).rmse_m, 1.1 * best.rmse_m);
  EXPECT_GT(prediction.ExactRmse(wasteful), 1.1 * best.rmse_m);
  EXPECT_EQ(search.OneFewer(wasteful).size(), 7);
  EXPECT_LE(prediction.ExactRmse(search.OneFewer(wasteful)), 1.1 * prediction.ExactRmse(wasteful));
}

TEST(UpdateKnots, KeepsKnotsThatAreNearEnoughAndElseChangesFew) {
  const ChordPrediction prediction = Prediction(MakeDriftingMission(300, /*seed=*/9));
  const KnotSet target = KnotSearch(prediction, KnotSearchOptions()).BestOf(6, {});
  std::vector<int> near = target.knots;
  near[3] += 1;
  EXPECT_EQ(UpdateKnots(prediction, near, target, /*allowed_loss_m=*/0.5), near);
  // What is far off is replaced, what is near stays.
  std::vector<int> far = near;
  far[1] = far[0] + 1;
  const std::vector<int> updated =
      UpdateKnots(prediction, far, target, 1.1 * (prediction.ExactRmse(near) - target.rmse_m));
  EXPECT_EQ(updated, near);
  EXPECT_EQ(UpdateKnots(prediction, far, target, 0), target.knots);
}

}  // namespace
}  // namespace overtone
