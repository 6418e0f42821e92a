// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/scene_builder.h"
#include "overtone/core/simulation/scenes.h"

namespace overtone {
namespace {

Space Chamber(double x, double y, const Eigen::Vector2d& axis, const Eigen::Vector2d& half_size,
              double height) {
  Space space;
  space.center = {x, y};
  space.axis = axis.normalized();
  space.half_size = half_size;
  space.height = height;
  space.roughness = 0.6;
  space.relief = 0.4;
  return space;
}

}  // namespace

// The hall in the middle, a room at the end of each of four tunnels, a fifth in the corner, and a
// ring of tunnels around.
Scene MakeTunnelScene(uint64_t seed) {
  SceneBuilder builder(seed);
  Space hall_space = Chamber(0, 0, {1, 0}, {0, 0}, 6);
  hall_space.radius = 9.5;
  const Room hall = builder.AddRoom(hall_space, {6, 6});
  const Room east = builder.AddRoom(Chamber(44, 6, {1, 0.2}, {8, 5.5}, 4), {4.5, 2.8});
  const Room corner = builder.AddRoom(Chamber(42, 44, {1, 1}, {6, 6}, 5), {3, 3});
  const Room north = builder.AddRoom(Chamber(4, 42, {-0.3, 1}, {7.5, 5}, 3.5), {4.2, 2.5});
  const Room west = builder.AddRoom(Chamber(-44, -4, {1, -0.4}, {7, 6.5}, 4.5), {3.8, 3.5});
  const Room south = builder.AddRoom(Chamber(-4, -40, {1, 0.1}, {9, 5}, 3), {5.5, 2.5});

  Space tunnel;
  tunnel.radius = 2.1;
  tunnel.height = 2.8;
  tunnel.roughness = 0.5;
  tunnel.relief = 0.7;
  builder.AddPassage(hall, {{14, 2}, {26, -1}}, east, tunnel);
  builder.AddPassage(hall, {{6, 16}, {1, 28}}, north, tunnel);
  builder.AddPassage(hall, {{-15, 2}, {-28, -3}}, west, tunnel);
  builder.AddPassage(hall, {{-5, -15}, {-1, -26}}, south, tunnel);
  builder.AddPassage(east, {{52, 18}, {50, 32}}, corner, tunnel);
  builder.AddPassage(corner, {{30, 50}, {18, 47}}, north, tunnel);
  builder.AddPassage(north, {{-12, 45}, {-26, 36}, {-36, 24}, {-40, 10}}, west, tunnel);
  builder.AddPassage(west, {{-40, -18}, {-31, -30}, {-18, -38}}, south, tunnel);
  builder.AddPassage(south, {{12, -38}, {28, -32}, {40, -20}, {46, -6}}, east, tunnel);

  for (const Eigen::Vector2d& pillar :
       {Eigen::Vector2d(2.5, 1), Eigen::Vector2d(-1.5, 2.5), Eigen::Vector2d(-1, -2.5)}) {
    builder.AddPillar(pillar, {0.5, 0.5});
  }
  builder.AddPillar({44, 6}, {0.9, 0.5});
  builder.AddPillar({-44, -4}, {0.6, 0.6});
  const std::vector<Space> spaces = builder.scene().plan.spaces;
  for (const Space& space : spaces) builder.Scatter(14, 0.45, 1.8, space);

  const NavigationGraph& graph = builder.graph();
  builder.scene().routes = {
      graph.Visit({hall[3], hall[0], east[0], corner[0], corner[3], north[0], hall[1], west[3]}),
      graph.Visit(
          {hall[0], hall[2], north[3], north[0], west[0], west[3], hall[3], hall[0], east[0]}),
      graph.Visit({hall[1], hall[4], south[0], south[3], west[3], west[0], hall[2], north[2]}),
      graph.Visit(
          {hall[2], hall[5], hall[0], east[3], east[0], south[0], south[3], hall[4], hall[1]})};
  return builder.scene();
}

}  // namespace overtone
