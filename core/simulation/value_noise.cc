// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/value_noise.h"

#include <cmath>

namespace overtone {
namespace {

// The finaliser of SplitMix64: every bit of the input reaches every bit of the result.
uint64_t Mix(uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

double ValueAt(uint64_t seed, int64_t x, int64_t y) {
  const uint64_t bits = Mix(Mix(Mix(seed) + static_cast<uint64_t>(x)) + static_cast<uint64_t>(y));
  return static_cast<double>(bits >> 11) * 0x1p-52 - 1;
}

double Blend(double a, double b, double t) { return a + (b - a) * t * t * (3 - 2 * t); }

}  // namespace

double ValueNoise(uint64_t seed, const Eigen::Vector2d& position) {
  const double x = std::floor(position.x()), y = std::floor(position.y());
  const auto i = static_cast<int64_t>(x), j = static_cast<int64_t>(y);
  const double u = position.x() - x;
  return Blend(Blend(ValueAt(seed, i, j), ValueAt(seed, i + 1, j), u),
               Blend(ValueAt(seed, i, j + 1), ValueAt(seed, i + 1, j + 1), u), position.y() - y);
}

}  // namespace overtone
