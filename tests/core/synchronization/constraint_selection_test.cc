// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/constraint_selection.h"

#include <algorithm>
#include <set>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/synchronization/constraint_generation.h"
#include "overtone/core/synchronization/wavelet_discrepancy.h"
#include "overtone/tests/support/golden_comparison.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// `n` nodes a metre apart along x, keyframe index = 10 * row; the robot believes in steps of 1.1 m
// behind row 4.
TrajectoryComparison StraightRun(int n) {
  TrajectoryComparison comparison;
  for (int i = 0; i < n; ++i) {
    const double drift = i > 4 ? 0.1 * (i - 4) : 0;
    comparison.keyframe_index.push_back(10 * i);
    comparison.server.emplace_back(Eigen::Quaterniond::Identity(), Eigen::Vector3d(i, 0, 0));
    comparison.onboard.emplace_back(Eigen::Quaterniond::Identity(),
                                    Eigen::Vector3d(i + drift, 5, 0));
    comparison.submap_start.push_back(i % 4 == 0);
    comparison.degenerate.push_back(false);
  }
  comparison.discrepancy = Eigen::MatrixXd::Zero(n, 3);
  comparison.revision = 2;
  return comparison;
}

std::vector<std::string> Ids(const std::vector<Constraint>& constraints) {
  std::vector<std::string> ids;
  for (const Constraint& constraint : constraints) ids.push_back(constraint.id);
  return ids;
}

SynchronizationOptions Options(SelectionStrategy strategy, int n) {
  SynchronizationOptions options;
  options.selection.strategy = strategy;
  options.selection.n = n;
  options.constraints.mid_hops = 3;
  options.constraints.large_min_path_m = 5;
  return options;
}

TEST(SubmapPivots, AreTheMiddlesOfTheSubmaps) {
  EXPECT_THAT(SubmapPivots({true, false, false, false, true, false, true}), ElementsAre(2, 5, 6));
  EXPECT_THAT(SubmapPivots({false, false, true}), ElementsAre(1, 2));
  EXPECT_THAT(SubmapPivots({}), IsEmpty());
}

TEST(SelectConstraints, TopNTurnsTheLargestEntriesIntoConstraintsAtTheirScale) {
  TrajectoryComparison comparison = StraightRun(12);  // pivots 2, 6, 10
  comparison.discrepancy(3, static_cast<int>(Band::kSmall)) = 0.5;
  comparison.discrepancy(3, static_cast<int>(Band::kMid)) = 0.4;
  comparison.discrepancy(1, static_cast<int>(Band::kLarge)) = 0.3;
  comparison.discrepancy(9, static_cast<int>(Band::kMid)) = 0.2;
  comparison.discrepancy(0, static_cast<int>(Band::kSmall)) = 0.05;  // below the floor
  EXPECT_THAT(Ids(SelectConstraints(comparison, Options(SelectionStrategy::kTopN, 3))),
              ElementsAre("large:10-100", "small:30-20", "small:30-10", "small:30-40",
                          "small:30-50", "mid:30-0", "mid:30-60"));
  EXPECT_THAT(Ids(SelectConstraints(comparison, Options(SelectionStrategy::kThreshold, 1))),
              ElementsAre("large:10-100", "small:30-20", "small:30-10", "small:30-40",
                          "small:30-50", "mid:30-0", "mid:30-60", "mid:90-60"));
  EXPECT_EQ(SelectConstraints(comparison, Options(SelectionStrategy::kTopN, 15)).size(), 8);
}

TEST(SelectConstraints, LargeConstraintsReachTheNearestPivotsWithinBounds) {
  TrajectoryComparison comparison = StraightRun(40);               // pivots 2, 6, 10, ..., 38
  comparison.discrepancy(21, static_cast<int>(Band::kLarge)) = 1;  // own pivot 22
  SynchronizationOptions options = Options(SelectionStrategy::kTopN, 1);
  options.constraints.large_min_distance_m = 7;
  options.constraints.large_max_distance_m = 13;
  options.constraints.large_neighbors = 3;
  EXPECT_THAT(Ids(SelectConstraints(comparison, options)),
              ElementsAre("large:210-140", "large:210-300", "large:210-100"));
  options.constraints.large_min_path_m = 9;
  EXPECT_THAT(Ids(SelectConstraints(comparison, options)),
              ElementsAre("large:210-100", "large:210-340"));
}

// A car's submaps of 20 s lie hundreds of metres apart.
TEST(SelectConstraints, LargeConstraintsReachSubmapsHundredsOfMetresAwayByDefault) {
  TrajectoryComparison comparison = StraightRun(12);  // pivots 2, 6, 10: 400 m apart
  for (Rigid3d& pose : comparison.server) pose.translation *= 100;
  comparison.discrepancy(5, static_cast<int>(Band::kLarge)) = 1;  // own pivot 6
  EXPECT_THAT(Ids(SelectConstraints(comparison, Options(SelectionStrategy::kTopN, 15))),
              ElementsAre("large:50-20", "large:50-100"));
}

TEST(SelectConstraints, DegenerateStretchesAreBridgedStepByStep) {
  TrajectoryComparison comparison = StraightRun(12);
  comparison.degenerate[0] = comparison.degenerate[5] = comparison.degenerate[6] = true;
  EXPECT_THAT(Ids(SelectConstraints(comparison, Options(SelectionStrategy::kTopN, 3))),
              ElementsAre("degenerate:40-50", "degenerate:50-60"));
}

TEST(SelectConstraints, CarriesTheServersRelativePoseAndItsCovariance) {
  const TrajectoryComparison comparison = StraightRun(12);
  SynchronizationOptions options = Options(SelectionStrategy::kUniform, 1);
  options.constraints.sigma_translation_m = 0.2;
  options.constraints.sigma_rotation_rad = 0.1;
  const std::vector<Constraint> chords = SelectConstraints(comparison, options);
  ASSERT_EQ(chords.size(), 1);
  EXPECT_EQ(chords[0].kind, ConstraintKind::kChord);
  EXPECT_EQ(chords[0].from, 0);
  EXPECT_EQ(chords[0].to, 110);
  EXPECT_NEAR(chords[0].from_tform_to.translation.x(), 11, 1e-12);
  EXPECT_NEAR(chords[0].score, 0.7, 1e-12);
  EXPECT_EQ(chords[0].revision, 2);
  EXPECT_NEAR(chords[0].covariance(2, 2), 0.04, 1e-15);
  EXPECT_NEAR(chords[0].covariance(3, 3), 0.01, 1e-15);
  EXPECT_EQ(chords[0].covariance(0, 5), 0);
}

TEST(SelectConstraints, UniformChordsShareThePathNotTheNodes) {
  TrajectoryComparison comparison = StraightRun(9);
  // The robot stands still for rows 5..8: the path ends at row 5.
  for (int i = 6; i < 9; ++i) comparison.server[i] = comparison.server[5];
  EXPECT_THAT(Ids(SelectConstraints(comparison, Options(SelectionStrategy::kUniform, 2))),
              ElementsAre("chord:0-30", "chord:30-80"));
  EXPECT_THAT(Ids(SelectConstraints(StraightRun(3), Options(SelectionStrategy::kUniform, 8))),
              ElementsAre("chord:0-10", "chord:10-20"));
}

TEST(SelectConstraints, UniformChordsCutAMissionThatNeverMoves) {
  TrajectoryComparison comparison = StraightRun(9);
  for (Rigid3d& pose : comparison.server) pose = Rigid3d();
  EXPECT_THAT(Ids(SelectConstraints(comparison, Options(SelectionStrategy::kUniform, 2))),
              ElementsAre("chord:0-40", "chord:40-80"));
}

TEST(SelectConstraints, RandomChordsDifferBySeedAndAreAsManyAsAskedFor) {
  const TrajectoryComparison comparison = StraightRun(50);
  SynchronizationOptions options = Options(SelectionStrategy::kRandom, 20);
  const auto first = Ids(SelectConstraints(comparison, options));
  EXPECT_EQ(std::set<std::string>(first.begin(), first.end()).size(), 20);
  EXPECT_EQ(first, Ids(SelectConstraints(comparison, options)));
  options.selection.seed = 2;
  EXPECT_NE(first, Ids(SelectConstraints(comparison, options)));
  // All pairs there are.
  EXPECT_EQ(SelectConstraints(StraightRun(3), options).size(), 3);
}

TEST(SelectConstraints, LargestEdgeErrorPicksTheStepsThatDiffer) {
  TrajectoryComparison comparison = StraightRun(12);  // every step behind row 4 is 0.1 m too long
  comparison.onboard[2].translation.y() += 0.5;       // both steps at row 2 are far off
  EXPECT_THAT(Ids(SelectConstraints(comparison, Options(SelectionStrategy::kLargestEdgeError, 2))),
              ElementsAre("small:10-20", "small:20-30"));
  EXPECT_EQ(SelectConstraints(comparison, Options(SelectionStrategy::kLargestEdgeError, 99)).size(),
            11);
}

TEST(SelectConstraints, AllTakesEveryStepAndNoneTakesNone) {
  EXPECT_EQ(SelectConstraints(StraightRun(12), Options(SelectionStrategy::kAll, 1)).size(), 11);
  EXPECT_THAT(SelectConstraints(StraightRun(12), Options(SelectionStrategy::kNone, 5)), IsEmpty());
}

// ---- The prototype's vectors ----

std::set<std::pair<int, int>> NodesAndBands(const std::vector<DiscrepancyLabel>& labels) {
  std::set<std::pair<int, int>> result;
  for (const DiscrepancyLabel& label : labels) {
    result.emplace(label.node, static_cast<int>(label.band));
  }
  return result;
}

// LARGE constraints of the configurations with pivots at every fifteenth node, whatever the
// submaps, are left out: that partition is not ours. None of those files holds one.
void ExpectMatchesPrototype(const golden::Case& c, int num_scales, const std::string& config) {
  const std::string name = "_s" + std::to_string(num_scales) + "_" + config;
  if (!c.Has("selection" + name + ".json")) return;
  SCOPED_TRACE(c.name() + name);
  const auto selection = nlohmann::json::parse(std::ifstream(c.File("selection" + name + ".json")));
  const auto comparison = CompareTrajectories(
      golden::Graph(golden::ReadPoses(c.File("poses_server.csv"))), {"robot", "mission"},
      golden::Trajectory(golden::ReadPoses(c.File("poses_robot.csv"))),
      golden::PrototypeOptions(c, num_scales));
  ASSERT_TRUE(comparison.ok()) << comparison.status();

  std::vector<DiscrepancyLabel> labels = golden::Labels(selection.at("labels_topclassifier"));
  if (selection.at("min_gap_between_ranked_top_features").get<double>() > 1e-9) {
    const auto ours = LargestDiscrepancies(
        comparison->discrepancy, selection.at("top_n_used").get<int>(),
        selection.at("config").at("top_classifier_min_threshold").get<double>());
    EXPECT_EQ(NodesAndBands(ours), NodesAndBands(labels));
  }

  if (selection.at("config").at("large_scale_partition_method") == "nth") {
    labels.erase(std::remove_if(labels.begin(), labels.end(),
                                [](const auto& label) { return label.band == Band::kLarge; }),
                 labels.end());
  }
  const auto constraints = ConstraintsAtScale(
      *comparison, labels, golden::PrototypeConstraintOptions(selection.at("config")));
  const auto expected = golden::ReadConstraints(c.File("constraints" + name + "_round1.csv"));
  ASSERT_EQ(constraints.size(), expected.size());
  for (int i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(constraints[i].from, expected[i].parent) << "row " << i;
    EXPECT_EQ(constraints[i].to, expected[i].child) << "row " << i;
    std::string kind(ToString(constraints[i].kind));
    std::transform(kind.begin(), kind.end(), kind.begin(), ::toupper);
    EXPECT_EQ(kind, expected[i].type) << "row " << i;
    const Rigid3d error = constraints[i].from_tform_to.Inverse() * expected[i].parent_from_child;
    EXPECT_LT(Log(error).norm(), 1e-9) << "row " << i;
  }
}

TEST(SelectConstraints, MatchesThePrototypesLabelsAndConstraints) {
  const std::vector<golden::Case> cases = golden::CasesIn(golden::SharedFolder());
  if (cases.empty()) GTEST_SKIP() << "no golden vectors in " << golden::SharedFolder();
  for (const golden::Case& c : cases) {
    for (const int num_scales : {6, 9}) {
      for (const std::string config : {"yaml10", "paper15", "nth30"}) {
        ExpectMatchesPrototype(c, num_scales, config);
      }
    }
  }
}

}  // namespace
}  // namespace overtone
