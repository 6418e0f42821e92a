// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/random.h"

#include <cmath>

namespace overtone {

double Random::Normal() {
  const double radius = std::sqrt(-2 * std::log(Uniform()));
  return radius * std::cos(2 * M_PI * Uniform());
}

Eigen::Vector3d Random::Normal3() {
  Eigen::Vector3d sample;
  for (int i = 0; i < 3; ++i) sample[i] = Normal();  // in this order on every compiler
  return sample;
}

}  // namespace overtone
