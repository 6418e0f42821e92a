// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/place_recognition/scan_context_proposer.h"

#include <cmath>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/mapping/cloud_verifier.h"
#include "overtone/core/mapping/loop_closure.h"
#include "overtone/tests/core/place_recognition/synthetic_place.h"
#include "overtone/tests/support/simulated_scans.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

NodeId Node(const std::string& robot, int64_t index) { return {{robot, "m0"}, index}; }

// At the synthetic place of that seed, turned left by yaw.
PlaceView View(const NodeId& node, double travelled_m, unsigned seed, double yaw_rad = 0) {
  PlaceView view;
  view.node = node;
  view.travelled_m = travelled_m;
  view.mission_from_body = Yaw(yaw_rad);
  view.cloud = std::make_shared<const PointCloud>(Turned(SyntheticPlace(seed), Yaw(-yaw_rad)));
  return view;
}

std::vector<NodeId> Froms(const std::vector<LoopCandidate>& candidates) {
  std::vector<NodeId> froms;
  for (const LoopCandidate& candidate : candidates) froms.push_back(candidate.from);
  return froms;
}

TEST(ScanContextProposerOptions, DefaultsAreValidAndNonsenseIsNot) {
  EXPECT_TRUE(ScanContextProposerOptions().Validate().ok());
  const auto refused = [](auto change) {
    ScanContextProposerOptions options;
    change(options);
    return !options.Validate().ok();
  };
  EXPECT_TRUE(refused([](auto& o) { o.min_similarity = 1.1; }));
  EXPECT_TRUE(refused([](auto& o) { o.min_similarity = std::nan(""); }));
  EXPECT_TRUE(refused([](auto& o) { o.max_candidates = 0; }));
  EXPECT_TRUE(refused([](auto& o) { o.max_comparisons = 0; }));
  EXPECT_TRUE(refused([](auto& o) { o.min_separation_m = -1; }));
  EXPECT_TRUE(refused([](auto& o) { o.min_loop_length_m = std::nan(""); }));
  EXPECT_TRUE(refused([](auto& o) { o.context.rings = 31; }));
}

TEST(ScanContextProposer, ProposesThePlaceSeenBeforeAndNoOther) {
  ScanContextProposer proposer({});
  for (int i = 0; i < 10; ++i) {
    EXPECT_THAT(proposer.Propose(View(Node("a", i), 20 * i, /*seed=*/i)), IsEmpty()) << i;
  }
  const auto candidates = proposer.Propose(View(Node("a", 10), 200, /*seed=*/4, /*yaw_rad=*/0.7));
  ASSERT_EQ(candidates.size(), 1u);
  const LoopCandidate& candidate = candidates[0];
  EXPECT_EQ(candidate.from, Node("a", 4));
  EXPECT_EQ(candidate.to, Node("a", 10));
  EXPECT_EQ(candidate.proposer, LoopEvidence::kScanContext);
  EXPECT_GT(candidate.score, 0.7);
  EXPECT_EQ(candidate.score_threshold, ScanContextProposerOptions().min_similarity);
  EXPECT_FALSE(candidate.measured);
  EXPECT_FALSE(candidate.registration.has_value());
}

// Both bodies tilted, too: from_R_to in their own frames, and not its inverse.
TEST(ScanContextProposer, GuessesTheRotationBetweenTiltedBodies) {
  const Eigen::Quaterniond map_from_a = ExpSO3({0.1, 0.2, 0.4});
  const Eigen::Quaterniond map_from_b = ExpSO3({-0.2, 0.1, -1.0});
  const PointCloud in_map = SyntheticPlace(7, -M_PI, M_PI, /*things=*/2400);
  const auto view = [&](const NodeId& node, const Eigen::Quaterniond& map_from_body) {
    return PlaceView{node, 0, map_from_body,
                     std::make_shared<const PointCloud>(Turned(in_map, map_from_body.conjugate()))};
  };
  ScanContextProposer proposer({});
  proposer.Propose(view(Node("a", 0), map_from_a));
  const auto candidates = proposer.Propose(view(Node("b", 0), map_from_b));
  ASSERT_EQ(candidates.size(), 1u);
  EXPECT_LT(
      candidates[0].from_tform_to.rotation.angularDistance(map_from_a.conjugate() * map_from_b),
      0.04);
  EXPECT_TRUE(candidates[0].from_tform_to.translation.isZero());
}

// What the guess is for: registration finds the pose from it.
TEST(ScanContextProposer, TheVerifierFindsThePoseFromTheGuess) {
  const Rigid3d world_from_a = StandingAt(2, 1, 0.3), world_from_b = StandingAt(1.2, 1.4, 2.9);
  Random random(3);
  const auto view = [&](const NodeId& node, const Rigid3d& world_from_body) {
    return PlaceView{
        node, 0, world_from_body.rotation,
        std::make_shared<const PointCloud>(Scan(HallWorld(), world_from_body, Scanner(), random))};
  };
  const PlaceView a = view(Node("a", 0), world_from_a), b = view(Node("b", 0), world_from_b);
  ScanContextProposer proposer({});
  proposer.Propose(a);
  auto candidates = proposer.Propose(b);
  ASSERT_EQ(candidates.size(), 1u);
  const CloudVerifier verifier({}, 10);
  ASSERT_TRUE(verifier.Verify(a, b, candidates[0]).ok());
  const Rigid3d truth = world_from_a.Inverse() * world_from_b;
  EXPECT_LT(Log(truth.Inverse() * candidates[0].from_tform_to).norm(), 0.05);
  EXPECT_EQ(JudgeFigures(candidates[0]), ClosureVerdict::kPending);
}

TEST(ScanContextProposer, AMissionsOwnPlacesCountOnceTheWayBackIsLongEnough) {
  ScanContextProposerOptions options;
  options.min_loop_length_m = 10;
  ScanContextProposer proposer(options);
  proposer.Propose(View(Node("a", 0), 100, 1));
  EXPECT_THAT(proposer.Propose(View(Node("a", 1), 109.9, 1)), IsEmpty());
  EXPECT_THAT(Froms(proposer.Propose(View(Node("a", 2), 110, 1))), ElementsAre(Node("a", 0)));
  // How far another mission has come says nothing.
  EXPECT_FALSE(proposer.Propose(View(Node("b", 0), 110, 1)).empty());
}

TEST(ScanContextProposer, NeighboursOfAPlaceAreOnePlace) {
  ScanContextProposerOptions options;
  options.min_separation_m = 2;
  ScanContextProposer proposer(options);
  const double travelled_m[] = {0, 1.9, 3.8};
  for (int i = 0; i < 3; ++i) proposer.Propose(View(Node("a", i), travelled_m[i], 1));
  // Equally alike: the first is chosen, then what is far enough from it.
  EXPECT_THAT(Froms(proposer.Propose(View(Node("b", 0), 0, 1))),
              ElementsAre(Node("a", 0), Node("a", 2)));
}

TEST(ScanContextProposer, PlacesOfTwoMissionsAreDistinctWhateverTheirWays) {
  ScanContextProposer proposer({});
  proposer.Propose(View(Node("a", 0), 5, 1));
  proposer.Propose(View(Node("b", 0), 5, 1));
  EXPECT_THAT(Froms(proposer.Propose(View(Node("c", 0), 5, 1))),
              testing::UnorderedElementsAre(Node("a", 0), Node("b", 0)));
}

TEST(ScanContextProposer, ProposesNoMoreThanAskedForBestFirst) {
  ScanContextProposerOptions options;
  options.max_candidates = 2;
  ScanContextProposer proposer(options);
  // Less of the place is seen from each keyframe.
  for (int i = 0; i < 4; ++i) {
    PlaceView view = View(Node("a", i), 20 * i, 1);
    PointCloud cloud = SyntheticPlace(1);
    for (size_t k = 0; k < cloud.size(); ++k) {
      if (static_cast<int>(k / 2 % 10) < i) cloud.points[k] *= 1.5f;
    }
    view.cloud = std::make_shared<const PointCloud>(cloud);
    proposer.Propose(view);
  }
  const auto candidates = proposer.Propose(View(Node("b", 0), 0, 1));
  EXPECT_THAT(Froms(candidates), ElementsAre(Node("a", 0), Node("a", 1)));
  EXPECT_GT(candidates[0].score, candidates[1].score);
}

TEST(ScanContextProposer, NamesTheMostSimilarPlaceBelowTheThresholdToo) {
  ScanContextProposerOptions options;
  options.min_similarity = 0.95;
  ScanContextProposer proposer(options);
  proposer.Propose(View(Node("a", 0), 0, 1));
  EXPECT_THAT(proposer.Propose(View(Node("b", 0), 0, 2)), IsEmpty());
  const auto nearest = proposer.MostSimilar(Node("b", 0));
  ASSERT_TRUE(nearest.has_value());
  EXPECT_EQ(nearest->from, Node("a", 0));
  EXPECT_EQ(nearest->to, Node("b", 0));
  EXPECT_GT(nearest->score, 0);
  EXPECT_LT(nearest->score, nearest->score_threshold);
  EXPECT_EQ(JudgeFigures(*nearest), ClosureVerdict::kRejectedScore);
}

TEST(ScanContextProposer, TheMostSimilarPlaceIsNotThePlaceItselfNorItsNeighbours) {
  ScanContextProposer proposer({});
  proposer.Propose(View(Node("a", 0), 0, 1));
  EXPECT_FALSE(proposer.MostSimilar(Node("a", 0)).has_value());
  proposer.Propose(View(Node("a", 1), 5, 1));
  EXPECT_FALSE(proposer.MostSimilar(Node("a", 1)).has_value());
  EXPECT_FALSE(proposer.MostSimilar(Node("a", 2)).has_value());
  EXPECT_FALSE(proposer.MostSimilar(Node("b", 0)).has_value());
  // One that came later answers for an earlier one.
  proposer.Propose(View(Node("a", 2), 50, 1));
  EXPECT_EQ(proposer.MostSimilar(Node("a", 0))->from, Node("a", 2));
}

TEST(ScanContextProposer, WhereAnyWayBackCountsThePlaceIsStillNotItsOwnNeighbour) {
  ScanContextProposerOptions options;
  options.min_loop_length_m = 0;
  ScanContextProposer proposer(options);
  proposer.Propose(View(Node("a", 0), 0, 1));
  EXPECT_FALSE(proposer.MostSimilar(Node("a", 0)).has_value());
}

TEST(ScanContextProposer, AViewWithoutPointsIsLikeNothing) {
  ScanContextProposer proposer({});
  proposer.Propose(View(Node("a", 0), 0, 1));
  const PlaceView empty = {Node("b", 0), 0, Yaw(0), std::make_shared<const PointCloud>()};
  EXPECT_THAT(proposer.Propose(empty), IsEmpty());
  EXPECT_FALSE(proposer.MostSimilar(Node("b", 0)).has_value());
  EXPECT_THAT(Froms(proposer.Propose(View(Node("c", 0), 0, 1))), ElementsAre(Node("a", 0)));
}

}  // namespace
}  // namespace overtone
