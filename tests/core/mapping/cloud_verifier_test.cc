// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/mapping/cloud_verifier.h"

#include <cmath>

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/core/mapping/multi_robot_map.h"
#include "overtone/tests/core/mapping/map_test_support.h"
#include "overtone/tests/support/simulated_scans.h"

namespace overtone {
namespace {

PlaceView ViewOf(const NodeId& node, PointCloud cloud) {
  PlaceView view;
  view.node = node;
  view.mission_from_body.setIdentity();
  view.cloud = std::make_shared<const PointCloud>(std::move(cloud));
  return view;
}

const NodeId kFrom = {Mission("a"), 0}, kTo = {Mission("b"), 0};

LoopCandidate Guess(const Rigid3d& from_tform_to) {
  LoopCandidate candidate;
  candidate.from = kFrom;
  candidate.to = kTo;
  candidate.proposer = LoopEvidence::kScanContext;
  candidate.score = candidate.score_threshold = 0.6;
  candidate.from_tform_to = from_tform_to;
  return candidate;
}

absl::Status Verify(const ScanPair& pair, LoopCandidate& candidate,
                    const CloudVerifierOptions& options = {}) {
  return CloudVerifier(options, 10)
      .Verify(ViewOf(kFrom, pair.target), ViewOf(kTo, pair.source), candidate);
}

ScanPair HallPair() {
  return ScanTwice(HallWorld(), StandingAt(2, 1, 0.9), StandingAt(0, 0, 0), Scanner(), 1);
}

ScanPair CorridorPair(double way_m) {
  return ScanTwice(CorridorWorld(), StandingAt(way_m, 0.2, 0.05), StandingAt(0, 0, 0), Scanner(),
                   2);
}

TEST(CloudVerifierOptions, DefaultsAreValidAndNonsenseIsNamed) {
  EXPECT_TRUE(CloudVerifierOptions().Validate().ok());
  const auto message = [](auto change) {
    CloudVerifierOptions options;
    change(options);
    return std::string(options.Validate().message());
  };
  using testing::HasSubstr;
  EXPECT_THAT(message([](auto& o) { o.required.min_overlap = 1.1; }), HasSubstr("min_overlap"));
  EXPECT_THAT(message([](auto& o) { o.required.max_residual_m = std::nan(""); }),
              HasSubstr("max_residual_m"));
  EXPECT_THAT(message([](auto& o) { o.max_translation_m = 0; }), HasSubstr("max_translation_m"));
  EXPECT_THAT(message([](auto& o) { o.registration.voxel_sizes_m = {}; }),
              HasSubstr("voxel_sizes_m"));
}

// Turned by half a radian and without any translation, as a proposer guesses.
TEST(CloudVerifier, MeasuresARevisitedPlaceWithinCentimetres) {
  const ScanPair pair = HallPair();
  LoopCandidate candidate = Guess(Planar(0, 0, 0.4));
  ASSERT_TRUE(Verify(pair, candidate).ok());
  const Vector6d error = Log(pair.target_from_source.Inverse() * candidate.from_tform_to);
  EXPECT_LT(error.head<3>().norm(), 0.03);
  EXPECT_LT(error.tail<3>().norm(), 0.005);
  EXPECT_TRUE(candidate.measured);
  ASSERT_TRUE(candidate.registration.has_value());
  EXPECT_TRUE(candidate.registration->converged);
  EXPECT_EQ(candidate.registration->open_directions, 0);
  EXPECT_EQ(candidate.registration->overlap_threshold, CloudVerifierOptions().required.min_overlap);
  EXPECT_EQ(candidate.registration->residual_limit_m,
            CloudVerifierOptions().required.max_residual_m);
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kPending);
  // As honest as 99.9 % of right ones.
  EXPECT_LT(error.dot(candidate.covariance.inverse() * error), 22.46);
  EXPECT_EQ(candidate.score, 0.6);
}

TEST(CloudVerifier, TwoDifferentPlacesOverlapTooLittle) {
  ScanPair pair = HallPair();
  Random random(5);
  pair.source = Scan(CorridorWorld(), StandingAt(0, 0, 0), Scanner(), random);
  LoopCandidate candidate = Guess(Rigid3d());
  ASSERT_TRUE(Verify(pair, candidate).ok());
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kRejectedOverlap)
      << "overlap " << candidate.registration->overlap;
}

TEST(CloudVerifier, ACorridorIsMeasuredButForItsAxis) {
  const ScanPair pair = CorridorPair(1);
  LoopCandidate candidate = Guess(Rigid3d());
  ASSERT_TRUE(Verify(pair, candidate).ok());
  EXPECT_GE(candidate.registration->open_directions, 1);
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kPending);
  const Eigen::Vector3d axis_in_to =
      candidate.from_tform_to.rotation.conjugate() * Eigen::Vector3d::UnitX();
  const Eigen::Matrix3d covariance = candidate.covariance.topLeftCorner<3, 3>();
  EXPECT_GT(std::sqrt(axis_in_to.dot(covariance * axis_in_to)), 10);
  // Across it, were the rest known: an axis milliradians askew turns its 100 m into decimetres.
  const Eigen::Matrix3d information = candidate.covariance.inverse().topLeftCorner<3, 3>();
  for (const int axis : {1, 2}) {
    const Eigen::Vector3d across = Eigen::Vector3d::Unit(axis);
    const Eigen::Vector3d direction = candidate.from_tform_to.rotation.conjugate() * across;
    EXPECT_LT(1 / std::sqrt(direction.dot(information * direction)), 0.05);
  }
  EXPECT_FALSE(RotationIsOpen(candidate.covariance));
  const Rigid3d error = pair.target_from_source.Inverse() * candidate.from_tform_to;
  EXPECT_LT(std::abs(error.translation.y()) + std::abs(error.translation.z()), 0.1);
  EXPECT_LT(LogSO3(error.rotation).norm(), 0.01);
}

// 20 m up a corridor and back to 3 m from the start, by odometry that has crept 1 m sideways. The
// registration cannot tell where along the axis the end is: guessed at the start, it stays near
// there. The closure straightens the way and leaves its length to odometry.
TEST(CloudVerifier, ACorridorDoesNotPullAlongItsAxisInTheMap) {
  std::vector<Rigid3d> truth, odometry;
  for (int i = 0; i <= 20; ++i) truth.push_back(StandingAt(i, 0, 0));
  for (int i = 19; i >= 3; --i) truth.push_back(StandingAt(i, 0, 0));
  const int last = static_cast<int>(truth.size()) - 1;
  for (int i = 0; i <= last; ++i) {
    odometry.push_back(Planar(0, 1.0 * i / last, 0) * truth[0].Inverse() * truth[i]);
  }
  const ScanPair pair = ScanTwice(CorridorWorld(), truth[last], truth[0], Scanner(), 4);
  LoopCandidate candidate = Guess(Rigid3d());
  ASSERT_TRUE(Verify(pair, candidate).ok());
  ASSERT_GT(std::abs(candidate.from_tform_to.translation.x() - 3), 1) << "nothing to withstand";
  candidate.from = {Mission("a"), 0};
  candidate.to = {Mission("a"), last};
  MultiRobotMap map{MultiRobotMapOptions()};
  ASSERT_TRUE(map.AddSubmap(Mission("a"), MakeSubmap(0, 0, odometry, Covariance(0.1, 0.02))).ok());
  ASSERT_TRUE(map.AddCandidate(candidate).ok());
  const auto snapshot = map.Optimise();
  EXPECT_EQ(ToString(snapshot->closures[0].verdict), "accepted") << Reason(snapshot->closures[0]);
  const Eigen::Vector3d end = snapshot->missions[0].map_from_body[last].translation;
  EXPECT_NEAR(end.x(), 3, 0.05);
  EXPECT_NEAR(end.y(), 0, 0.1);
}

TEST(CloudVerifier, TooFewPointsAreAnErrorAndLeaveTheCandidateAsItIs) {
  ScanPair pair = HallPair();
  pair.source.points.resize(5);
  const LoopCandidate before = Guess(Planar(1, 2, 0.3));
  LoopCandidate candidate = before;
  EXPECT_EQ(Verify(pair, candidate).code(), absl::StatusCode::kInvalidArgument);
  EXPECT_FALSE(candidate.measured);
  EXPECT_FALSE(candidate.registration.has_value());
  EXPECT_EQ(candidate.from_tform_to.ToMatrix(), before.from_tform_to.ToMatrix());
  EXPECT_EQ(candidate.covariance, before.covariance);
}

TEST(CloudVerifier, ARegistrationThatSlippedTooFarHasNotConverged) {
  const ScanPair pair = HallPair();  // 2.2 m apart
  CloudVerifierOptions options;
  options.max_translation_m = 2;
  LoopCandidate candidate = Guess(pair.target_from_source);
  ASSERT_TRUE(Verify(pair, candidate, options).ok());
  EXPECT_FALSE(candidate.registration->converged);
  EXPECT_EQ(JudgeFigures(candidate), ClosureVerdict::kRejectedOverlap);
  options.max_translation_m = 2.5;
  candidate = Guess(pair.target_from_source);
  ASSERT_TRUE(Verify(pair, candidate, options).ok());
  EXPECT_TRUE(candidate.registration->converged);
}

TEST(CloudVerifier, ForgettingPyramidsChangesNothing) {
  const ScanPair pair = HallPair();
  const auto measure = [&](const CloudVerifier& verifier) {
    LoopCandidate candidate = Guess(pair.target_from_source);
    EXPECT_TRUE(
        verifier.Verify(ViewOf(kFrom, pair.target), ViewOf(kTo, pair.source), candidate).ok());
    return candidate.from_tform_to.ToMatrix();
  };
  const CloudVerifier remembers({}, 10), forgets({}, 0);
  const Eigen::Matrix4d first = measure(remembers);
  EXPECT_EQ(measure(remembers), first);
  EXPECT_EQ(measure(forgets), first);
}

}  // namespace
}  // namespace overtone
