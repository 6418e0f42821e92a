// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/synchronization/position_noise.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace overtone {
namespace {

// Squared length of a Gaussian vector of three dimensions: its median, variance 1 for each axis.
constexpr double kMedianOfThree = 2.366;

Eigen::Vector3d Bend(const std::vector<Rigid3d>& poses, size_t i) {
  return poses[i].rotation.conjugate() *
         (poses[i - 1].translation - 2 * poses[i].translation + poses[i + 1].translation);
}

}  // namespace

double PositionNoise(const TrajectoryComparison& comparison) {
  std::vector<double> squares;
  for (size_t i = 1; i + 1 < comparison.server.size(); ++i) {
    squares.push_back((Bend(comparison.server, i) - Bend(comparison.onboard, i)).squaredNorm());
  }
  if (squares.empty()) return 0;
  const auto middle = squares.begin() + static_cast<int>(squares.size()) / 2;
  std::nth_element(squares.begin(), middle, squares.end());
  constexpr double kVariances = 1 + 4 + 1;  // of a node's, in a second difference
  return std::sqrt(3 * *middle / kMedianOfThree / kVariances);
}

}  // namespace overtone
