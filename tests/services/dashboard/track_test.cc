// SPDX-License-Identifier: Apache-2.0
#include "overtone/services/dashboard/track.h"

#include "gmock/gmock.h"
#include "gtest/gtest.h"
#include "overtone/services/dashboard/track_frame.h"
#include "overtone/tests/services/dashboard/decoded_frame.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

// Keyframe i at (i, 2 i, 3 i), by odometry at (i, 0, 0).
v1::GetTrajectoryResponse Straight(int nodes, bool odometry) {
  v1::GetTrajectoryResponse trajectory;
  for (int i = 0; i < nodes; ++i) {
    v1::Node& node = *trajectory.add_nodes();
    node.set_index(i);
    node.mutable_map_tform_body()->mutable_position()->set_x(i);
    node.mutable_map_tform_body()->mutable_position()->set_y(2 * i);
    node.mutable_map_tform_body()->mutable_position()->set_z(3 * i);
    if (odometry) trajectory.add_odometry()->mutable_position()->set_x(i);
  }
  return trajectory;
}

TEST(Track, EveryThirdKeyframeIsKeptAndTheLastOne) {
  const Track track = MapPositions(Straight(8, false), Eigen::Vector3d::Zero(), 3);
  EXPECT_THAT(track.index, ElementsAre(0, 3, 6, 7));
  EXPECT_THAT(track.values, ElementsAre(0, 0, 0, 3, 6, 9, 6, 12, 18, 7, 14, 21));
  EXPECT_THAT(MapPositions(Straight(7, false), Eigen::Vector3d::Zero(), 3).index,
              ElementsAre(0, 3, 6));
  EXPECT_THAT(MapPositions(Straight(0, false), Eigen::Vector3d::Zero(), 3).index, IsEmpty());
}

// Floats hold seven digits: at 5,000 km a millimetre survives only because the origin is taken off
// before.
TEST(Track, FarFromTheMapsOriginMillimetresSurvive) {
  v1::GetTrajectoryResponse trajectory = Straight(1, false);
  trajectory.mutable_nodes(0)->mutable_map_tform_body()->mutable_position()->set_x(5'000'000.003);
  const Track track = MapPositions(trajectory, {5'000'000, 0, 0}, 1);
  EXPECT_NEAR(track.values[0], 0.003, 1e-6);
}

TEST(Track, OdometryIsThereForEveryNodeOrNotAtAll) {
  EXPECT_THAT(OdometryPositions(Straight(3, true), 2).values, ElementsAre(0, 0, 0, 2, 0, 0));
  v1::GetTrajectoryResponse cut = Straight(3, true);
  cut.mutable_odometry()->RemoveLast();
  EXPECT_THAT(OdometryPositions(cut, 1).index, IsEmpty());
}

TEST(Track, ADiscrepancyOfUnequalColumnsIsNone) {
  v1::ComparisonReport comparison;
  for (int i = 0; i < 3; ++i) {
    comparison.add_index(10 * i);
    comparison.add_small(1);
    comparison.add_mid(2);
    comparison.add_large(static_cast<float>(i));
  }
  EXPECT_THAT(Discrepancy(comparison).index, ElementsAre(0, 10, 20));
  EXPECT_THAT(Discrepancy(comparison).values, ElementsAre(1, 2, 0, 1, 2, 1, 1, 2, 2));
  comparison.add_mid(2);
  EXPECT_THAT(Discrepancy(comparison).index, IsEmpty());
}

TEST(Track, AreAlikeWithinTheToleranceAndWithTheSameRows) {
  const Track track = MapPositions(Straight(5, false), Eigen::Vector3d::Zero(), 1);
  Track other = track;
  other.values[7] += 0.0009f;
  EXPECT_TRUE(AreAlike(track, other, 1e-3f));
  other.values[7] += 0.001f;
  EXPECT_FALSE(AreAlike(track, other, 1e-3f));
  EXPECT_FALSE(AreAlike(track, Thinned(track, 2), 1e-3f));
}

TEST(TrackFrame, IsReadAsItWasWritten) {
  TrackFrame frame(9'000'000'001, {1.5, -2.5, 1e6});
  const Track track = MapPositions(Straight(5, false), Eigen::Vector3d::Zero(), 2);
  frame.Add(7, track);
  frame.Add(3, Track());
  const testing::DecodedFrame decoded(frame.bytes());
  EXPECT_EQ(decoded.version, 9'000'000'001.0);
  EXPECT_THAT(decoded.origin, ElementsAre(1.5, -2.5, 1e6));
  ASSERT_EQ(decoded.tracks.size(), 2u);
  EXPECT_EQ(decoded.tracks.at(7).index, track.index);
  EXPECT_EQ(decoded.tracks.at(7).values, track.values);
  EXPECT_THAT(decoded.tracks.at(3).index, IsEmpty());
}

}  // namespace
}  // namespace overtone
