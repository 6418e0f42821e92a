// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/noise_floor.h"

#include <random>

#include "gtest/gtest.h"

namespace overtone {
namespace {

constexpr int kNumNodes = 300;
constexpr double kSigma = 0.03;

// Magnitudes of Gaussian coefficients, of sigma, 2 sigma and 3 sigma in the three bands; and poses
// along a line, of which the server's are off by 2 sigma.
TrajectoryComparison Noise(int seed, double sigma = kSigma, uint64_t map_epoch = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  TrajectoryComparison comparison;
  comparison.map_epoch = map_epoch;
  for (int i = 0; i < kNumNodes; ++i) {
    const double error = i == 0 ? 0 : 2 * sigma * normal(random);
    comparison.onboard.push_back({Eigen::Quaterniond::Identity(), Eigen::Vector3d(10.0 * i, 0, 0)});
    comparison.server.push_back(comparison.onboard.back());
    comparison.server.back().translation.x() += error;
  }
  comparison.discrepancy.resize(kNumNodes, 3);
  for (int band = 0; band < 3; ++band) {
    for (double& value : comparison.discrepancy.col(band)) {
      value = (band + 1) * sigma * std::abs(normal(random));
    }
  }
  return comparison;
}

void Learn(NoiseFloor& floor, int first_seed, int count) {
  for (int seed = first_seed; seed < first_seed + count; ++seed) floor.Learn(Noise(seed));
}

// sqrt(2) times the signals' 2 sigma.
TEST(NoiseFloor, BeforeItHasLearnedTheSignalsOwnNoiseStandsForAllBands) {
  NoiseFloor floor{SynchronizationOptions()};
  TrajectoryComparison comparison = Noise(1);
  for (int i = 0; i < kNumNodes; ++i) {  // drift does not count
    comparison.server[i].translation.x() += 0.01 * i;
  }
  for (const BandLevel& level : floor.Judge(comparison)) {
    EXPECT_FALSE(level.exceeds);
    EXPECT_NEAR(level.noise, 2.83 * kSigma, 0.4 * kSigma);
  }
  comparison.discrepancy.col(0).array() += 1;  // of all nodes
  EXPECT_TRUE(floor.Judge(comparison)[0].exceeds);
  EXPECT_FALSE(floor.Judge(comparison)[1].exceeds);
}

TEST(NoiseFloor, SwitchedOffEverythingExceeds) {
  SynchronizationOptions options;
  options.noise_floor.enabled = false;
  for (const BandLevel& level : NoiseFloor(options).Judge(Noise(1))) EXPECT_TRUE(level.exceeds);
}

TEST(NoiseFloor, LearnsTheDeviationOfEachBand) {
  NoiseFloor floor{SynchronizationOptions()};
  Learn(floor, 1, 10);
  const BandLevels levels = floor.Judge(Noise(11));
  for (int band = 0; band < 3; ++band) {
    EXPECT_NEAR(levels[band].noise, (band + 1) * kSigma, 0.1 * (band + 1) * kSigma);
  }
}

TEST(NoiseFloor, FalseAlarmsAreAsRareAsTheOptionSays) {
  constexpr int kComparisons = 20000;
  SynchronizationOptions options;
  options.noise_floor.false_alarm_probability = 0.01;
  NoiseFloor floor(options);
  Learn(floor, 1, 16);
  int alarms = 0;
  for (int seed = 100; seed < 100 + kComparisons; ++seed) {
    alarms += AnyExceeds(floor.Judge(Noise(seed)));
  }
  RecordProperty("alarms_of_20000", alarms);
  EXPECT_LE(alarms, 0.01 * kComparisons);
  EXPECT_GT(alarms, 0);  // else the limit would be out of proportion
}

TEST(NoiseFloor, ANodeThatHasDriftedByEightDeviationsIsFoundInItsBand) {
  NoiseFloor floor{SynchronizationOptions()};
  Learn(floor, 1, 8);
  for (int seed = 10; seed < 110; ++seed) {
    TrajectoryComparison drifted = Noise(seed);
    drifted.discrepancy(200, 1) = 8 * 2 * kSigma;
    const BandLevels levels = floor.Judge(drifted);
    EXPECT_TRUE(levels[1].exceeds) << "seed " << seed;
    EXPECT_NEAR(levels[1].largest, 8, 1);
    EXPECT_FALSE(levels[0].exceeds || levels[2].exceeds) << "seed " << seed;
  }
}

TEST(NoiseFloor, DriftedNodesDoNotTeachIt) {
  NoiseFloor floor{SynchronizationOptions()};
  for (int seed = 1; seed <= 10; ++seed) {
    TrajectoryComparison drifted = Noise(seed);
    drifted.discrepancy.bottomRows(kNumNodes / 4).array() += 1;
    floor.Learn(drifted);
  }
  const BandLevels levels = floor.Judge(Noise(11));
  for (int band = 0; band < 3; ++band) EXPECT_LT(levels[band].noise, 1.5 * (band + 1) * kSigma);
  TrajectoryComparison drifted = Noise(12);
  drifted.discrepancy.bottomRows(kNumNodes / 4).array() += 1;
  EXPECT_TRUE(AnyExceeds(floor.Judge(drifted)));
}

TEST(NoiseFloor, WhatDriftsSlowlyCannotHide) {
  NoiseFloor floor{SynchronizationOptions()};
  Learn(floor, 1, 8);
  double drift_m = 0;
  for (int seed = 10; seed < 1000; ++seed) {
    TrajectoryComparison drifting = Noise(seed);
    drift_m += 0.002;  // of all nodes
    drifting.discrepancy.col(0).array() += drift_m;
    if (AnyExceeds(floor.Judge(drifting))) break;
    floor.Learn(drifting);
  }
  EXPECT_LT(drift_m, 12 * kSigma);  // twice the noise that it was, times its limit of 5.2
}

TEST(NoiseFloor, IsNeverFinerThanWhatIsPublished) {
  NoiseFloor floor{SynchronizationOptions()};
  for (int seed = 1; seed <= 8; ++seed) floor.Learn(Noise(seed, 1e-5));
  const BandLevels levels = floor.Judge(Noise(6, 2e-3 / 3));
  EXPECT_FALSE(AnyExceeds(levels));
  for (const BandLevel& level : levels) EXPECT_NEAR(level.noise, 2e-3, 2e-4);
}

TEST(NoiseFloor, StaysFromRevisionToRevisionAndBeginsAnewWithAnotherMap) {
  NoiseFloor floor{SynchronizationOptions()};
  Learn(floor, 1, 8);
  TrajectoryComparison later = Noise(4);
  later.revision = 1000;
  EXPECT_NEAR(floor.Judge(later)[0].noise, kSigma, 0.1 * kSigma);
  later.map_epoch = 2;  // nothing is known of it
  EXPECT_NEAR(floor.Judge(later)[0].noise, 2.83 * kSigma, 0.4 * kSigma);
  for (int seed = 5; seed < 13; ++seed) floor.Learn(Noise(seed, 2 * kSigma, 2));
  EXPECT_NEAR(floor.Judge(later)[0].noise, 2 * kSigma, 0.2 * kSigma);
}

}  // namespace
}  // namespace overtone
