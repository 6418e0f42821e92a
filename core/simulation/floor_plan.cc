// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/floor_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "overtone/core/simulation/value_noise.h"

namespace overtone {
namespace {

// Wavelengths, metres: of what is seen of a wall from one place, and of the ground walked over.
constexpr double kCoarseM = 3.1;
constexpr double kFineM = 1.3;
constexpr double kReliefM = 13;
// How far the relief of one space reaches into the next, metres: no steps in between.
constexpr double kReliefBlendM = 4;

double Roughness(uint64_t seed, const Eigen::Vector2d& position) {
  return 0.7 * ValueNoise(seed, position / kCoarseM) +
         0.3 * ValueNoise(seed + 1, position / kFineM);
}

}  // namespace

double Space::Distance(const Eigen::Vector2d& position) const {
  const Eigen::Vector2d p = position - center;
  const Eigen::Vector2d q(std::abs(axis.dot(p)) - half_size.x(),
                          std::abs(axis.x() * p.y() - axis.y() * p.x()) - half_size.y());
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0) - radius;
}

FloorPlan::Column FloorPlan::At(const Eigen::Vector2d& position) const {
  const double wall_noise = Roughness(seed, position);
  double wall = std::numeric_limits<double>::infinity();
  const Space* nearest = nullptr;
  double sum = 0, weights = 0;
  for (const Space& space : spaces) {
    const double distance = space.Distance(position);
    if (distance + space.roughness * wall_noise < wall) {
      wall = distance + space.roughness * wall_noise;
      nearest = &space;
    }
    const double reach = kReliefBlendM + std::max(distance, 0.0);
    const double weight = 1 / (reach * reach * reach * reach);
    sum += weight * space.relief;
    weights += weight;
  }
  if (nearest == nullptr) return {wall, 0, 0};
  const double ground = sum / weights * ValueNoise(seed + 2, position / kReliefM);
  const double ceiling =
      ground + nearest->height + nearest->roughness * Roughness(seed + 3, position);
  return {wall, ground, ceiling};
}

}  // namespace overtone
