// SPDX-License-Identifier: Apache-2.0
// Lays rooms and passages, each with the ways through it, so that plan and graph fit each other.
#ifndef OVERTONE_CORE_SIMULATION_SCENE_BUILDER_H_
#define OVERTONE_CORE_SIMULATION_SCENE_BUILDER_H_

#include <cstdint>
#include <vector>

#include "overtone/core/simulation/random.h"
#include "overtone/core/simulation/scene.h"

namespace overtone {

// A room's waypoints, a ring of six inside it, anticlockwise.
using Room = std::vector<int>;

class SceneBuilder {
 public:
  explicit SceneBuilder(uint64_t seed);

  // A space that robots drive round in. Its ring is an ellipse of `ring` semi-axes along the
  // space's own; the walls' roughness must leave it room.
  Room AddRoom(const Space& space, const Eigen::Vector2d& ring);

  // A passage from room to room by way of `bends`, `style.radius` to each side; style's other
  // members but height, roughness and relief are not read. It joins each ring at the waypoint
  // nearest to where it comes from. Returns the waypoints at its bends.
  std::vector<int> AddPassage(const Room& from, const std::vector<Eigen::Vector2d>& bends,
                              const Room& to, const Space& style);

  // A pillar from ground to ceiling, round where half_size has equal sides.
  void AddPillar(const Eigen::Vector2d& center, const Eigen::Vector2d& half_size);

  // Up to `count` boxes and cylinders at random places of `space`, of half sizes up to half_size
  // and heights up to height, where they leave all ways open. After the last way.
  void Scatter(int count, double half_size, double height, const Space& space);

  NavigationGraph& graph() { return scene_.graph; }
  Scene& scene() { return scene_; }

 private:
  void Stand(Obstacle obstacle, double height);

  Random random_;
  Scene scene_;
};

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_SCENE_BUILDER_H_
