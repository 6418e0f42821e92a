// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/uniform_spline.h"

#include <algorithm>

namespace overtone {

SplinePoint EvaluateSpline(const std::vector<Eigen::Vector2d>& control, double u) {
  const int last_segment = static_cast<int>(control.size()) - 4;
  const int k = std::min(static_cast<int>(u), last_segment);
  const double t = u - k;
  const double s = 1 - t;
  const Eigen::Vector2d &a = control[k], &b = control[k + 1], &c = control[k + 2],
                        &d = control[k + 3];
  return {(s * s * s * a + (3 * t * t * t - 6 * t * t + 4) * b +
           (3 * s * s * s - 6 * s * s + 4) * c + t * t * t * d) /
              6,
          (s * s * (b - a) + (1 + 2 * t * s) * (c - b) + t * t * (d - c)) / 2};
}

}  // namespace overtone
