// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/scene_builder.h"

#include <array>
#include <cmath>

namespace overtone {
namespace {

constexpr double kClearanceM = 1.3;  // between a way and what is scattered about
constexpr double kFootingM = 2;      // how deep things reach into the ground, which is not level

// The corners of a regular hexagon.
const std::array<Eigen::Vector2d, 6> kHexagon = {Eigen::Vector2d(1, 0),
                                                 Eigen::Vector2d(0.5, 0.8660254037844386),
                                                 Eigen::Vector2d(-0.5, 0.8660254037844386),
                                                 Eigen::Vector2d(-1, 0),
                                                 Eigen::Vector2d(-0.5, -0.8660254037844386),
                                                 Eigen::Vector2d(0.5, -0.8660254037844386)};

// From the axes of a space to the world's.
Eigen::Vector2d Along(const Eigen::Vector2d& axis, const Eigen::Vector2d& v) {
  return {axis.x() * v.x() - axis.y() * v.y(), axis.y() * v.x() + axis.x() * v.y()};
}

int Nearest(const NavigationGraph& graph, const Room& room, const Eigen::Vector2d& position) {
  int nearest = room.front();
  for (const int waypoint : room) {
    if ((graph.positions()[waypoint] - position).norm() <
        (graph.positions()[nearest] - position).norm()) {
      nearest = waypoint;
    }
  }
  return nearest;
}

}  // namespace

SceneBuilder::SceneBuilder(uint64_t seed) : random_(seed) { scene_.plan.seed = random_.Fork(); }

Room SceneBuilder::AddRoom(const Space& space, const Eigen::Vector2d& ring) {
  scene_.plan.spaces.push_back(space);
  Room room;
  for (const Eigen::Vector2d& corner : kHexagon) {
    room.push_back(
        graph().AddWaypoint(space.center + Along(space.axis, corner.cwiseProduct(ring))));
  }
  for (size_t i = 0; i < room.size(); ++i) graph().Connect(room[i], room[(i + 1) % room.size()]);
  return room;
}

std::vector<int> SceneBuilder::AddPassage(const Room& from,
                                          const std::vector<Eigen::Vector2d>& bends, const Room& to,
                                          const Space& style) {
  const auto& positions = graph().positions();
  std::vector<int> at_bends;
  at_bends.reserve(bends.size());
  for (const Eigen::Vector2d& bend : bends) at_bends.push_back(graph().AddWaypoint(bend));
  // Without bends, each end is the one nearest to the other room's first waypoint.
  const Eigen::Vector2d towards_from = bends.empty() ? positions[to.front()] : bends.front();
  const Eigen::Vector2d towards_to = bends.empty() ? positions[from.front()] : bends.back();
  std::vector<int> chain = {Nearest(graph(), from, towards_from)};
  chain.insert(chain.end(), at_bends.begin(), at_bends.end());
  chain.push_back(Nearest(graph(), to, towards_to));
  for (size_t i = 1; i < chain.size(); ++i) {
    graph().Connect(chain[i - 1], chain[i]);
    const Eigen::Vector2d a = positions[chain[i - 1]], b = positions[chain[i]];
    Space tunnel = style;
    tunnel.center = (a + b) / 2;
    tunnel.axis = (b - a).normalized();
    tunnel.half_size = {(b - a).norm() / 2, 0};
    scene_.plan.spaces.push_back(tunnel);
  }
  return at_bends;
}

void SceneBuilder::AddPillar(const Eigen::Vector2d& center, const Eigen::Vector2d& half_size) {
  Obstacle pillar;
  pillar.center = center;
  pillar.half_size = half_size;
  pillar.round = half_size.x() == half_size.y();
  Stand(pillar, kOpenSky);
}

void SceneBuilder::Scatter(int count, double half_size, double height, const Space& space) {
  for (int i = 0; i < count; ++i) {
    double draw[6];  // all of them, whether or not the place will do: one thing shifts no other
    for (double& d : draw) d = 2 * random_.Uniform() - 1;
    Obstacle obstacle;
    const Eigen::Vector2d reach = space.half_size + Eigen::Vector2d::Constant(space.radius);
    obstacle.center =
        space.center + Along(space.axis, reach.cwiseProduct(Eigen::Vector2d(draw[0], draw[1])));
    obstacle.axis = Eigen::Vector2d(draw[2], 1).normalized();
    obstacle.half_size = half_size * Eigen::Vector2d(0.6 + 0.4 * draw[3], 0.6 + 0.4 * draw[4]);
    obstacle.round = i % 3 == 0;
    const bool open = scene_.plan.At(obstacle.center).wall < 0;
    if (open && graph().DistanceToWay(obstacle.center) > kClearanceM + obstacle.Radius()) {
      Stand(obstacle, height * (0.6 + 0.4 * draw[5]));
    }
  }
}

void SceneBuilder::Stand(Obstacle obstacle, double height) {
  const double ground = scene_.plan.At(obstacle.center).ground;
  obstacle.bottom = ground - kFootingM;
  obstacle.top = ground + height;
  scene_.plan.obstacles.push_back(obstacle);
}

}  // namespace overtone
