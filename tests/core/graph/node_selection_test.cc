// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/graph/node_selection.h"

#include <limits>

#include "gmock/gmock.h"
#include "gtest/gtest.h"

namespace overtone {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

std::vector<Rigid3d> AlongX(const std::vector<double>& x) {
  std::vector<Rigid3d> poses;
  for (const double value : x) {
    poses.emplace_back(Eigen::Quaterniond::Identity(), Eigen::Vector3d(value, 0, 0));
  }
  return poses;
}

TEST(SelectKeyframes, KeepsWhatMovedFarEnoughFromTheLastOneKept) {
  EXPECT_THAT(SelectKeyframes(AlongX({0, 0.5, 1, 1.5, 1.75, 2.25, 2.5}), {1, kInfinity}),
              ElementsAre(0, 2, 5, 6));
}

TEST(SelectKeyframes, MeasuresDistanceStraightSoHoveringAddsNothing) {
  EXPECT_THAT(SelectKeyframes(AlongX({0, 0.5, 0, 0.5, 0, 0.5, 0}), {0.9, kInfinity}),
              ElementsAre(0, 6));
}

TEST(SelectKeyframes, KeepsWhatTurnedFarEnough) {
  std::vector<Rigid3d> turning;
  for (int i = 0; i < 8; ++i)
    turning.emplace_back(ExpSO3({0, 0, 0.2 * i}), Eigen::Vector3d::Zero());
  EXPECT_THAT(SelectKeyframes(turning, {kInfinity, 0.5}), ElementsAre(0, 3, 6, 7));
}

TEST(SelectKeyframes, AlwaysKeepsTheFirstAndTheLast) {
  EXPECT_THAT(SelectKeyframes({}, {1, 1}), IsEmpty());
  EXPECT_THAT(SelectKeyframes(AlongX({3}), {1, 1}), ElementsAre(0));
  EXPECT_THAT(SelectKeyframes(AlongX({0, 0, 0, 0}), {1, 1}), ElementsAre(0, 3));
}

TEST(SelectKeyframes, KeepsEverythingAtZero) {
  EXPECT_THAT(SelectKeyframes(AlongX({0, 0, 0}), {0, kInfinity}), ElementsAre(0, 1, 2));
}

TEST(KeyframeSelectionOptions, DefaultsAreValidAndNonsenseIsNot) {
  EXPECT_TRUE(KeyframeSelectionOptions().Validate().ok());
  for (const double bad : {-1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_EQ((KeyframeSelectionOptions{bad, 1}.Validate().message()),
              "min_distance_m: must be >= 0");
    EXPECT_EQ((KeyframeSelectionOptions{1, bad}.Validate().message()),
              "min_rotation_rad: must be >= 0");
  }
}

}  // namespace
}  // namespace overtone
