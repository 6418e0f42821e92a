// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/drift_onset.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "overtone/core/synchronization/odometry_model.h"

namespace overtone {
namespace {

constexpr int kMaxNodes = 400;
constexpr double kMedianChiSquare = 5.348;  // of six degrees of freedom
// 2 ln L of one stretch at 99.99 %, and what comes of having n^2 / 2 of them to choose from.
constexpr double kChiSquareOfOne = 27.86;

double LimitFor(int num_nodes) { return kChiSquareOfOne + 4 * std::log(std::max(num_nodes, 2)); }

double Median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<int>(values.size()) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Step errors and their variances (per axis: covariances of steps are all but diagonal), summed
// from the first node on.
struct Sums {
  std::vector<Vector6d> error = {Vector6d::Zero()};
  std::vector<Vector6d> variance = {Vector6d::Zero()};

  double Ratio(int from, int to) const {
    const Vector6d s = error[to] - error[from];
    return (s.array().square() / (variance[to] - variance[from]).array()).sum();
  }
};

Sums SumSteps(const TrajectoryComparison& comparison, const SynchronizationOptions& options,
              const SelectionContext& context) {
  const std::vector<Rigid3d>& odometry =
      context.odometry.empty() ? comparison.onboard : context.odometry;
  Sums sums;
  std::vector<double> chi_squares;
  for (int i = 1; i < odometry.size(); ++i) {
    const Rigid3d step = odometry[i - 1].Inverse() * odometry[i];
    const Matrix6d covariance = context.step_covariance.empty()
                                    ? OdometryCovariance(step, options.odometry)
                                    : context.step_covariance[i];
    const Rigid3d server = comparison.server[i - 1].Inverse() * comparison.server[i];
    sums.error.push_back(sums.error.back() + Log(step.Inverse() * server));
    sums.variance.push_back(sums.variance.back() + covariance.diagonal());
    chi_squares.push_back(sums.Ratio(i - 1, i));
  }
  const double scale = Median(chi_squares) / kMedianChiSquare;
  if (!(scale > 0)) return Sums();
  for (Vector6d& variance : sums.variance) variance *= scale;
  return sums;
}

// The stretch of the largest ratio whose ends are multiples of `stride` within the two ranges.
DriftOnset Largest(const Sums& sums, int stride, int first, int last, int end_first, int end_last) {
  DriftOnset largest;
  for (int from = std::max(first, 0); from <= last; from += stride) {
    for (int to = std::max(end_first, from + stride); to <= end_last; to += stride) {
      const double ratio = sums.Ratio(from, to);
      if (ratio <= largest.log_likelihood_ratio) continue;
      largest.row = from;
      largest.end_row = to;
      largest.log_likelihood_ratio = ratio;
    }
  }
  return largest;
}

}  // namespace

Band StandingOutBand(const Eigen::MatrixXd& discrepancy, int row) {
  Band band = Band::kSmall;
  double largest = 0;
  for (const Band candidate : {Band::kLarge, Band::kMid, Band::kSmall}) {
    const int column = static_cast<int>(candidate);
    const Eigen::VectorXd entries = discrepancy.col(column);
    const double floor =
        Median(std::vector<double>(entries.data(), entries.data() + entries.size()));
    const double ratio = floor > 0 ? entries[row] / floor : 0;
    if (ratio > largest) {
      largest = ratio;
      band = candidate;
    }
  }
  return band;
}

std::optional<DriftOnset> FindDriftOnset(const TrajectoryComparison& comparison,
                                         const SynchronizationOptions& options,
                                         const SelectionContext& context) {
  const int last = static_cast<int>(comparison.server.size()) - 1;
  if (last < 2) return std::nullopt;
  const Sums sums = SumSteps(comparison, options, context);
  if (sums.error.size() < 2) return std::nullopt;
  const int stride = 1 + last / kMaxNodes;
  DriftOnset onset = Largest(sums, stride, 0, last, 1, last);
  if (stride > 1) {
    onset = Largest(sums, 1, onset.row - stride, std::min(onset.row + stride, last),
                    onset.end_row - stride, std::min(onset.end_row + stride, last));
  }
  if (onset.log_likelihood_ratio < LimitFor(last)) return std::nullopt;
  onset.keyframe_index = comparison.keyframe_index[onset.row];
  onset.band = StandingOutBand(comparison.discrepancy, onset.row);
  return onset;
}

}  // namespace overtone
