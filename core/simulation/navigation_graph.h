// SPDX-License-Identifier: Apache-2.0
// Where robots drive in a simulated world: waypoints and the straight ways between them.
#ifndef OVERTONE_CORE_SIMULATION_NAVIGATION_GRAPH_H_
#define OVERTONE_CORE_SIMULATION_NAVIGATION_GRAPH_H_

#include <utility>
#include <vector>

#include "Eigen/Core"
#include "overtone/core/simulation/random.h"

namespace overtone {

// A walk never turns by more than kSharpestTurnDeg at a waypoint, so that a robot can follow it
// without stopping: a graph must offer such a turn at the end of every way (IsDrivable). A dead end
// has a loop to turn round in.
class NavigationGraph {
 public:
  static constexpr double kSharpestTurnDeg = 135;

  int AddWaypoint(const Eigen::Vector2d& position);  // world frame, metres; returns its number
  void Connect(int a, int b);                        // two different waypoints, both ways

  const std::vector<Eigen::Vector2d>& positions() const { return positions_; }
  const std::vector<std::pair<int, int>>& ways() const { return ways_; }
  // From `position` to the nearest way.
  double DistanceToWay(const Eigen::Vector2d& position) const;

  // Waypoints that may follow `at` for who comes from `from`; all neighbours when from is -1.
  std::vector<int> Onward(int from, int at) const;
  bool IsDrivable() const;

  // The shortest walk from stops[0] to stops[1], from there to stops[2], and so on, each leg as the
  // one before lets it begin. Up to where a stop cannot be reached. Dijkstra over directed ways.
  std::vector<int> Visit(const std::vector<int>& stops) const;

  // Lengthens a walk, of at least one waypoint, until it is at least length_m long: always onto the
  // way taken least often, at random among several.
  void Explore(double length_m, Random& random, std::vector<int>* walk) const;

  double Length(const std::vector<int>& walk) const;  // metres

 private:
  double LengthOf(int a, int b) const { return (positions_[a] - positions_[b]).norm(); }
  std::vector<int> Leg(int from, int at, int stop) const;

  std::vector<Eigen::Vector2d> positions_;
  std::vector<std::vector<int>> neighbours_;
  std::vector<std::pair<int, int>> ways_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_NAVIGATION_GRAPH_H_
