// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/noise_floor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "overtone/core/synchronization/trajectory_signal.h"

namespace overtone {
namespace {

constexpr double kDeviationsPerMedian = 1.4826;  // of a Gaussian's magnitude
constexpr size_t kMemory = 16;                   // comparisons
constexpr size_t kFewest = 8;
constexpr double kLargestGrowth = 2;

template <typename Values>
double Median(const Values& values) {
  std::vector<double> sorted(values.begin(), values.end());
  const auto middle = sorted.begin() + static_cast<int>(sorted.size()) / 2;
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

double NoiseOf(const TrajectoryComparison& comparison, int band) {
  const Eigen::VectorXd magnitudes = comparison.discrepancy.col(band);
  return kDeviationsPerMedian * Median(magnitudes);
}

// What the largest error of a published pose does to the signal.
double LeastNoise(const SynchronizationOptions& options) {
  Vector6d error;
  error << options.noise_floor.published_tolerance_m, 0, 0,
      options.noise_floor.published_tolerance_rad, 0, 0;
  return TrajectorySignal({Rigid3d(), Exp(error)}, options.signal, options.graph.metric,
                          options.signal_weights)
      .row(1)
      .norm();
}

// Of a band's coefficients by the noise of single nodes: of two scales, each of which passes it all
// at the most.
double WhiteNoise(const TrajectoryComparison& comparison, const SynchronizationOptions& options) {
  const auto signal = [&](const std::vector<Rigid3d>& poses) {
    return TrajectorySignal(poses, options.signal, options.graph.metric, options.signal_weights);
  };
  const Eigen::MatrixXd difference = signal(comparison.server) - signal(comparison.onboard);
  const Eigen::Index inside = difference.rows() - 2;
  const Eigen::VectorXd bends = (difference.topRows(inside) - 2 * difference.middleRows(1, inside) +
                                 difference.bottomRows(inside))
                                    .rowwise()
                                    .norm();
  return std::sqrt(2.0 / 6.0) * kDeviationsPerMedian * Median(bends);
}

}  // namespace

NoiseFloor::NoiseFloor(const SynchronizationOptions& options)
    : options_(options),
      least_(LeastNoise(options)),
      lowest_(Eigen::Array3d::Constant(std::numeric_limits<double>::infinity())) {}

Eigen::Array3d NoiseFloor::Typical() const {
  Eigen::Array3d typical;
  for (int band = 0; band < 3; ++band) {
    std::vector<double> values;
    for (const Eigen::Array3d& one : learned_) values.push_back(one[band]);
    typical[band] = Median(values);
  }
  return typical;
}

Eigen::Array3d NoiseFloor::Noise(const TrajectoryComparison& comparison) const {
  if (learned_.size() >= kFewest && comparison.map_epoch == map_epoch_) {
    return Typical().min(kLargestGrowth * lowest_).max(least_);
  }
  return Eigen::Array3d::Constant(std::max(WhiteNoise(comparison, options_), least_));
}

BandLevels NoiseFloor::Judge(const TrajectoryComparison& comparison) const {
  const Eigen::Array3d noise = Noise(comparison);
  const double num_coefficients = 3.0 * static_cast<double>(comparison.discrepancy.rows());
  const double limit =
      std::sqrt(2 * std::log(num_coefficients / options_.noise_floor.false_alarm_probability));
  BandLevels levels;
  for (int band = 0; band < 3; ++band) {
    levels[band].noise = noise[band];
    levels[band].largest = comparison.discrepancy.col(band).maxCoeff() / noise[band];
    levels[band].exceeds = !options_.noise_floor.enabled || levels[band].largest > limit;
  }
  return levels;
}

void NoiseFloor::Learn(const TrajectoryComparison& comparison) {
  if (comparison.map_epoch != map_epoch_) {
    learned_.clear();
    lowest_.setConstant(std::numeric_limits<double>::infinity());
    map_epoch_ = comparison.map_epoch;
  }
  Eigen::Array3d noise;
  for (int band = 0; band < 3; ++band) noise[band] = NoiseOf(comparison, band);
  learned_.push_back(noise);
  if (learned_.size() > kMemory) learned_.pop_front();
  if (learned_.size() >= kFewest) lowest_ = lowest_.min(Typical());
}

bool AnyExceeds(const BandLevels& levels) {
  return std::any_of(levels.begin(), levels.end(),
                     [](const BandLevel& level) { return level.exceeds; });
}

}  // namespace overtone
