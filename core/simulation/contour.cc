// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/contour.h"

namespace overtone {

void AppendContour(const std::array<double, 4>& values, std::vector<Segment>* segments) {
  static const std::array<Eigen::Vector2d, 4> kCorners = {
      Eigen::Vector2d(0, 0), Eigen::Vector2d(1, 0), Eigen::Vector2d(1, 1), Eigen::Vector2d(0, 1)};
  // Once around: the line enters the negative side at one crossing and leaves it at the next.
  std::vector<Eigen::Vector2d> enters, leaves;
  bool first_enters = true;
  for (int i = 0; i < 4; ++i) {
    const int next = (i + 1) % 4;
    const double a = values[i], b = values[next];
    if ((a < 0) == (b < 0)) continue;
    if (enters.empty() && leaves.empty()) first_enters = b < 0;
    (b < 0 ? enters : leaves).push_back(kCorners[i] + a / (a - b) * (kCorners[next] - kCorners[i]));
  }
  const size_t count = enters.size();
  for (size_t k = 0; k < count; ++k) {
    segments->push_back({enters[k], leaves[first_enters ? k : (k + 1) % count]});
  }
}

}  // namespace overtone
