// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/place_recognition/scan_context.h"

#include <cmath>
#include <limits>

#include "gtest/gtest.h"
#include "overtone/core/geometry/se3.h"
#include "overtone/tests/core/place_recognition/synthetic_place.h"

namespace overtone {
namespace {

const ScanContextOptions kOptions;
constexpr double kSector = 2 * M_PI / 60;

ScanContext Upright(const PointCloud& cloud) {
  return ComputeScanContext(cloud, Eigen::Quaterniond::Identity(), kOptions);
}

TEST(ScanContextOptions, DefaultsAreValidAndNonsenseIsNot) {
  EXPECT_TRUE(kOptions.Validate().ok());
  const auto refused = [](auto change) {
    ScanContextOptions options;
    change(options);
    return !options.Validate().ok();
  };
  EXPECT_TRUE(refused([](auto& o) { o.min_range_m = 0; }));
  EXPECT_TRUE(refused([](auto& o) { o.max_range_m = o.min_range_m; }));
  EXPECT_TRUE(refused([](auto& o) { o.max_range_m = std::numeric_limits<double>::infinity(); }));
  EXPECT_TRUE(refused([](auto& o) { o.rings = 31; }));
  EXPECT_TRUE(refused([](auto& o) { o.sectors = 3; }));
  EXPECT_TRUE(refused([](auto& o) { o.min_common_share = std::nan(""); }));
}

TEST(ScanContext, APointGoesToItsRingAndLeaksIntoTheTwoBeside) {
  PointCloud cloud;
  cloud.points = {{10, 0.1f, -1}, {10, 0.1f, 2}};  // the highest counts: 3 m above the ground
  const ScanContext context = Upright(cloud);
  const int ring = static_cast<int>(30 * std::log(10) / std::log(80));
  const Eigen::VectorXf column = context.columns.col(30);
  EXPECT_NEAR(column.norm(), 1, 1e-6);
  EXPECT_NEAR(column[ring - 1] / column[ring], 0.5, 1e-6);
  EXPECT_NEAR(column[ring + 1] / column[ring], 0.5, 1e-6);
  EXPECT_EQ((column.array() > 0).count(), 3);
  EXPECT_EQ(context.seen.sum(), 1);
}

// One 3 m above the ground against one at it: 4 and 1.
TEST(ScanContext, TallThingsWeighMore) {
  PointCloud cloud;
  cloud.points = {{10, 0.1f, -1}, {10, 0.1f, 2}, {30, 0.3f, -1}};
  const Eigen::VectorXf column = Upright(cloud).columns.col(30);
  EXPECT_NEAR(column[static_cast<int>(30 * std::log(10) / std::log(80))] /
                  column[static_cast<int>(30 * std::log(30) / std::log(80))],
              4, 1e-5);
}

TEST(ScanContext, TurningByWholeSectorsShiftsColumnsAndLeavesTheRingKey) {
  const PointCloud cloud = SyntheticPlace(/*seed=*/1, -1, 2);
  const ScanContext before = Upright(cloud);
  const ScanContext after = Upright(Turned(cloud, Yaw(7 * kSector)));
  for (int sector = 0; sector < 60; ++sector) {
    EXPECT_TRUE(after.columns.col((sector + 7) % 60).isApprox(before.columns.col(sector), 1e-5));
  }
  EXPECT_TRUE(after.ring_key.isApprox(before.ring_key, 1e-5));
}

TEST(ScanContext, WhatIsOutOfRangeOrMissingSeesNothing) {
  PointCloud cloud;
  cloud.points = {{0.5f, 0.1f, 0}, {90, 0, 0}, {0, 0, 5}};
  for (const ScanContext& context : {Upright(cloud), Upright({})}) {
    EXPECT_TRUE(context.columns.isZero());
    EXPECT_TRUE(context.ring_key.isZero());
    EXPECT_EQ(CompareScanContexts(context, context, kOptions).similarity, 0);
    EXPECT_EQ(CompareScanContexts(Upright(SyntheticPlace(1)), context, kOptions).similarity, 0);
  }
}

TEST(CompareScanContexts, IsOneWithItselfAndLessWithAnother) {
  const ScanContext place = Upright(SyntheticPlace(1));
  EXPECT_NEAR(CompareScanContexts(place, place, kOptions).similarity, 1, 1e-5);
  EXPECT_NEAR(CompareScanContexts(place, place, kOptions).yaw_rad, 0, 1e-3);
  EXPECT_LT(CompareScanContexts(place, Upright(SyntheticPlace(2)), kOptions).similarity, 0.7);
}

TEST(CompareScanContexts, IsSymmetricAndYawChangesItsSign) {
  const ScanContext a = Upright(SyntheticPlace(1, -2, 1));
  const ScanContext b = Upright(Turned(SyntheticPlace(1, -1, 2), Yaw(0.77)));
  const ScanContextMatch ab = CompareScanContexts(a, b, kOptions);
  const ScanContextMatch ba = CompareScanContexts(b, a, kOptions);
  EXPECT_NEAR(ab.similarity, ba.similarity, 1e-6);
  EXPECT_NEAR(ab.yaw_rad, -ba.yaw_rad, 1e-4);
}

// p_from = Rz(yaw) p_to: the same things seen `turn` further left in `from` than in `to`.
TEST(CompareScanContexts, FindsTheYawToLessThanASector) {
  const PointCloud cloud = SyntheticPlace(3, -M_PI, M_PI, /*things=*/2400);
  double worst = 0;
  for (double turn = -3.1; turn < 3.1; turn += 0.23) {
    const ScanContextMatch match =
        CompareScanContexts(Upright(Turned(cloud, Yaw(turn))), Upright(cloud), kOptions);
    worst = std::max(worst, std::abs(std::remainder(match.yaw_rad - turn, 2 * M_PI)));
  }
  EXPECT_LT(worst, 0.3 * kSector) << "half a sector is what no refinement would leave";
}

TEST(CompareScanContexts, SectorsThatOneDidNotSeeDoNotCount) {
  const ScanContext everything = Upright(SyntheticPlace(4));
  const ScanContext quarter = Upright(SyntheticPlace(4, -8 * kSector, 8 * kSector));
  EXPECT_EQ(quarter.seen.sum(), 16);
  EXPECT_NEAR(CompareScanContexts(everything, quarter, kOptions).similarity, 1, 1e-5);
}

TEST(CompareScanContexts, FewCommonSectorsCountLessAndTooFewNothing) {
  const ScanContext left = Upright(SyntheticPlace(5, 0, 1.6));
  const ScanContext ahead = Upright(SyntheticPlace(5, -0.4, 1.2));
  const ScanContextMatch match = CompareScanContexts(left, ahead, kOptions);
  EXPECT_NEAR(match.yaw_rad, 0, 0.05);
  EXPECT_LT(match.similarity, 0.95);
  ScanContextOptions strict;
  strict.min_common_share = 0.9;
  EXPECT_LT(CompareScanContexts(left, ahead, strict).similarity, match.similarity);
}

TEST(CompareScanContexts, SeeingHardlyAnythingIsNoCertainty) {
  const ScanContext glimpse = Upright(SyntheticPlace(6, 0, 0.2));
  EXPECT_LT(CompareScanContexts(glimpse, glimpse, kOptions).similarity, 0.5);
}

TEST(LevelFromBody, StandsUprightAndKeepsTheHeading) {
  const Eigen::Quaterniond mission_from_body = ExpSO3({0.3, -0.2, 2.5});
  const Eigen::Quaterniond level_from_body = LevelFromBody(mission_from_body);
  const Eigen::Vector3d up_in_body = mission_from_body.conjugate() * Eigen::Vector3d::UnitZ();
  EXPECT_TRUE((level_from_body * up_in_body).isApprox(Eigen::Vector3d::UnitZ(), 1e-12));
  const Eigen::Vector3d ahead = level_from_body * Eigen::Vector3d::UnitX();
  EXPECT_NEAR(ahead.y(), 0, 1e-12);
  EXPECT_GT(ahead.x(), 0);
}

// Two tilted bodies at one spot: level frames, yaw between them, and back.
TEST(BodyRotation, UndoesBothTilts) {
  const Eigen::Quaterniond map_from_a = ExpSO3({0.1, 0.2, 0.4});
  const Eigen::Quaterniond map_from_b = ExpSO3({-0.2, 0.1, -1.0});
  const PointCloud in_map = SyntheticPlace(7, -M_PI, M_PI, 2400);
  const Eigen::Quaterniond level_from_a = LevelFromBody(map_from_a);
  const Eigen::Quaterniond level_from_b = LevelFromBody(map_from_b);
  const ScanContextMatch match = CompareScanContexts(
      ComputeScanContext(Turned(in_map, map_from_a.conjugate()), level_from_a, kOptions),
      ComputeScanContext(Turned(in_map, map_from_b.conjugate()), level_from_b, kOptions), kOptions);
  EXPECT_GT(match.similarity, 0.9);
  const Eigen::Quaterniond a_from_b = BodyRotation(level_from_a, match.yaw_rad, level_from_b);
  EXPECT_LT(a_from_b.angularDistance(map_from_a.conjugate() * map_from_b), 0.3 * kSector);
}

}  // namespace
}  // namespace overtone
