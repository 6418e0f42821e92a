// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/navigation_graph.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <queue>
#include <tuple>

namespace overtone {

int NavigationGraph::AddWaypoint(const Eigen::Vector2d& position) {
  positions_.push_back(position);
  neighbours_.emplace_back();
  return static_cast<int>(positions_.size()) - 1;
}

void NavigationGraph::Connect(int a, int b) {
  neighbours_[a].push_back(b);
  neighbours_[b].push_back(a);
  ways_.emplace_back(a, b);
}

double NavigationGraph::DistanceToWay(const Eigen::Vector2d& position) const {
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& [a, b] : ways_) {
    const Eigen::Vector2d along = positions_[b] - positions_[a], to = position - positions_[a];
    const double t = std::clamp(to.dot(along) / along.squaredNorm(), 0.0, 1.0);
    nearest = std::min(nearest, (to - t * along).norm());
  }
  return nearest;
}

std::vector<int> NavigationGraph::Onward(int from, int at) const {
  if (from < 0) return neighbours_[at];
  static const double kSmallestCosine = std::cos(kSharpestTurnDeg * M_PI / 180);
  const Eigen::Vector2d heading = (positions_[at] - positions_[from]).normalized();
  std::vector<int> onward;
  for (const int next : neighbours_[at]) {
    const Eigen::Vector2d direction = (positions_[next] - positions_[at]).normalized();
    if (heading.dot(direction) >= kSmallestCosine) onward.push_back(next);
  }
  return onward;
}

bool NavigationGraph::IsDrivable() const {
  for (const auto& [a, b] : ways_) {
    if (Onward(a, b).empty() || Onward(b, a).empty()) return false;
  }
  return !ways_.empty();
}

// What follows `at` up to `stop`; empty when it cannot be reached, or is reached already.
std::vector<int> NavigationGraph::Leg(int from, int at, int stop) const {
  using Way = std::pair<int, int>;
  std::map<Way, Way> way_before;
  std::priority_queue<std::tuple<double, Way, Way>, std::vector<std::tuple<double, Way, Way>>,
                      std::greater<>>
      queue;
  const Way start(from, at);
  queue.push({0, start, start});
  while (!queue.empty()) {
    const auto [length, way, before] = queue.top();
    queue.pop();
    if (!way_before.emplace(way, before).second) continue;
    if (way.second == stop) {
      std::vector<int> leg;
      for (Way back = way; back != start; back = way_before.at(back)) leg.push_back(back.second);
      return {leg.rbegin(), leg.rend()};
    }
    for (const int next : Onward(way.first, way.second)) {
      queue.push({length + LengthOf(way.second, next), {way.second, next}, way});
    }
  }
  return {};
}

std::vector<int> NavigationGraph::Visit(const std::vector<int>& stops) const {
  std::vector<int> walk;
  for (const int stop : stops) {
    if (walk.empty()) {
      walk.push_back(stop);
      continue;
    }
    const int from = walk.size() > 1 ? walk[walk.size() - 2] : -1;
    const std::vector<int> leg = Leg(from, walk.back(), stop);
    if (leg.empty() && walk.back() != stop) break;
    walk.insert(walk.end(), leg.begin(), leg.end());
  }
  return walk;
}

void NavigationGraph::Explore(double length_m, Random& random, std::vector<int>* walk) const {
  const auto key = [](int a, int b) { return std::pair<int, int>(std::minmax({a, b})); };
  std::map<std::pair<int, int>, int> times_taken;
  for (size_t i = 1; i < walk->size(); ++i) ++times_taken[key((*walk)[i - 1], (*walk)[i])];
  double length = Length(*walk);
  while (length < length_m) {
    const int at = walk->back();
    const int from = walk->size() > 1 ? (*walk)[walk->size() - 2] : -1;
    std::vector<int> best;
    for (const int next : Onward(from, at)) {
      const int times = times_taken[key(at, next)];
      if (!best.empty() && times > times_taken[key(at, best.front())]) continue;
      if (!best.empty() && times < times_taken[key(at, best.front())]) best.clear();
      best.push_back(next);
    }
    if (best.empty()) return;
    const int next = best[random.Below(static_cast<int>(best.size()))];
    ++times_taken[key(at, next)];
    length += LengthOf(at, next);
    walk->push_back(next);
  }
}

double NavigationGraph::Length(const std::vector<int>& walk) const {
  double length = 0;
  for (size_t i = 1; i < walk.size(); ++i) length += LengthOf(walk[i - 1], walk[i]);
  return length;
}

}  // namespace overtone
