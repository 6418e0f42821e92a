// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/campus.h"

#include <cmath>

#include "overtone/core/simulation/ground_pose.h"

namespace overtone {
namespace {

// Hills: kAmplitudeM * sin(x / kHillX) * cos(y / kHillY), metres.
constexpr double kAmplitudeM = 1.5;
constexpr double kHillX = 9;
constexpr double kHillY = 11;

bool OnCampus(const Eigen::Vector2i& junction) {
  return junction.minCoeff() >= 0 && junction.maxCoeff() < Campus::kJunctionsPerSide;
}

// The next direction to go: straight on, left or right, whichever stays on the campus.
Eigen::Vector2i NextDirection(const Eigen::Vector2i& junction, const Eigen::Vector2i& last,
                              Random& random) {
  const Eigen::Vector2i left(-last.y(), last.x());
  std::vector<Eigen::Vector2i> open;
  for (const Eigen::Vector2i& direction : {last, left, Eigen::Vector2i(-left)}) {
    if (OnCampus(junction + direction)) open.push_back(direction);
  }
  return open[random.Below(
      static_cast<int>(open.size()))];  // never empty: a corner has two streets
}

}  // namespace

double Campus::Height(const Eigen::Vector2d& position) {
  return kAmplitudeM * std::sin(position.x() / kHillX) * std::cos(position.y() / kHillY);
}

Eigen::Vector2d Campus::Slope(const Eigen::Vector2d& position) {
  const double x = position.x() / kHillX;
  const double y = position.y() / kHillY;
  return kAmplitudeM *
         Eigen::Vector2d(std::cos(x) * std::cos(y) / kHillX, -std::sin(x) * std::sin(y) / kHillY);
}

Rigid3d Campus::PoseOnGround(const Eigen::Vector2d& position, const Eigen::Vector2d& heading) {
  return PoseOnSlope({position.x(), position.y(), Height(position)}, Slope(position), heading);
}

std::vector<Eigen::Vector2d> Campus::RandomWalk(int num_streets, Random& random) {
  Eigen::Vector2i junction;
  for (int i = 0; i < 2; ++i) junction[i] = random.Below(kJunctionsPerSide);
  // Where it came from need not exist, so any direction does; that it differs between robots is
  // all that matters.
  Eigen::Vector2i direction =
      random.Below(2) == 0 ? Eigen::Vector2i::UnitX() : Eigen::Vector2i::UnitY();
  std::vector<Eigen::Vector2d> positions;
  for (int street = 0; street < num_streets; ++street) {
    direction = NextDirection(junction, direction, random);
    for (int i = 0; i < kPointsPerStreet; ++i) {
      positions.push_back(
          kBlockM * (junction.cast<double>() + direction.cast<double>() * i / kPointsPerStreet));
    }
    junction += direction;
  }
  positions.push_back(kBlockM * junction.cast<double>());
  return positions;
}

}  // namespace overtone
