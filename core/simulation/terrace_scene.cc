// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/scene_builder.h"
#include "overtone/core/simulation/scenes.h"

namespace overtone {
namespace {

Space Hall(double x, double y, const Eigen::Vector2d& half_size, double height) {
  Space space;
  space.center = {x, y};
  space.half_size = half_size;
  space.height = height;
  return space;
}

}  // namespace

// A building west of x = 0, its lobby's door at the origin, and the terrace east of it. The fence
// and the masts around the terrace are beyond 50 m of every way.
Scene MakeTerraceScene(uint64_t seed) {
  SceneBuilder builder(seed);
  const Space lobby_space = Hall(-10, 0, {9, 8}, 4);
  const Space north_space = Hall(-14, 24, {9, 6}, 3);
  const Space west_space = Hall(-42, 0, {8, 10}, 3.5);
  const Space south_space = Hall(-12, -25, {10, 6}, 3);
  const Space terrace_space = Hall(100, 0, {100, 100}, kOpenSky);
  const Room lobby = builder.AddRoom(lobby_space, {5.5, 5});
  const Room north = builder.AddRoom(north_space, {5.5, 3});
  const Room west = builder.AddRoom(west_space, {4.5, 6});
  const Room south = builder.AddRoom(south_space, {6, 3});
  const Room terrace = builder.AddRoom(terrace_space, {45, 40});

  Space aisle;
  aisle.radius = 1.5;
  aisle.height = 2.6;
  builder.AddPassage(lobby, {{-10, 10}}, north, aisle);
  builder.AddPassage(north, {{-30, 24}, {-40, 18}}, west, aisle);
  builder.AddPassage(west, {{-40, -18}, {-30, -25}}, south, aisle);
  builder.AddPassage(south, {{-8, -15}}, lobby, aisle);
  builder.AddPassage(lobby, {{-24, 0}}, west, aisle);
  builder.AddPassage(lobby, {{4, 0}}, terrace, aisle);

  builder.scene().plan.sky = 8;  // and so high are the walls towards the terrace
  for (const Eigen::Vector2d& mast :
       {Eigen::Vector2d(198, 60), Eigen::Vector2d(160, 97), Eigen::Vector2d(196, -75)}) {
    builder.AddPillar(mast, {0.6, 0.6});
  }
  builder.AddPillar({-10, 1.5}, {0.5, 0.5});
  builder.AddPillar({-42, -2}, {0.4, 1.2});
  builder.Scatter(30, 0.8, 1.6, lobby_space);
  builder.Scatter(40, 0.8, 1.4, north_space);
  builder.Scatter(40, 1.0, 2.2, west_space);
  builder.Scatter(40, 0.6, 1.0, south_space);
  builder.scene().terrace =
      Eigen::AlignedBox2d(Eigen::Vector2d(6, -100), Eigen::Vector2d(200, 100));

  const NavigationGraph& graph = builder.graph();
  builder.scene().routes = {graph.Visit({lobby[3], north[0], west[1], lobby[3], terrace[4],
                                         terrace[0], terrace[2], lobby[0], south[0]}),
                            graph.Visit({lobby[1], lobby[5], terrace[2], terrace[0], terrace[4],
                                         lobby[0], lobby[2], north[0], west[0]}),
                            graph.Visit({lobby[2], south[0], south[3], west[5], west[2], north[3],
                                         lobby[1], lobby[4], south[2], west[4], lobby[3]})};
  return builder.scene();
}

}  // namespace overtone
