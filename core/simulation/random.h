// SPDX-License-Identifier: Apache-2.0
// Random numbers that are the same on every platform: the standard fixes std::mt19937_64, but
// leaves its distributions to the implementation.
#ifndef OVERTONE_CORE_SIMULATION_RANDOM_H_
#define OVERTONE_CORE_SIMULATION_RANDOM_H_

#include <cstdint>
#include <random>

#include "Eigen/Core"

namespace overtone {

class Random {
 public:
  explicit Random(uint64_t seed) : engine_(seed) {}

  // In [0, n), n > 0. The bias of the modulus is below n / 2^64.
  int Below(int n) { return static_cast<int>(engine_() % static_cast<uint64_t>(n)); }
  // In (0, 1], all 53 bits of it.
  double Uniform() { return static_cast<double>((engine_() >> 11) + 1) * 0x1p-53; }
  // Standard normal. Box & Muller, Ann. Math. Statist. 29(2), 1958; the second value is not kept.
  double Normal();
  // Three independent ones.
  Eigen::Vector3d Normal3();
  // The seed of an independent generator, so that one robot's draws do not shift another's.
  uint64_t Fork() { return engine_(); }

 private:
  std::mt19937_64 engine_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_RANDOM_H_
