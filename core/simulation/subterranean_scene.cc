// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/scene_builder.h"
#include "overtone/core/simulation/scenes.h"

namespace overtone {
namespace {

Space Round(double x, double y, double radius, double height, double roughness, double relief) {
  Space space;
  space.center = {x, y};
  space.radius = radius;
  space.height = height;
  space.roughness = roughness;
  space.relief = relief;
  return space;
}

Space Rectangle(double x, double y, const Eigen::Vector2d& half_size) {
  Space space;
  space.center = {x, y};
  space.half_size = half_size;
  return space;
}

}  // namespace

// One hall; mine tunnels north of it, a built-up grid in the east, a cave in the south-west, and a
// way from each to the next.
Scene MakeSubterraneanScene(uint64_t seed) {
  SceneBuilder builder(seed);
  const Room hall = builder.AddRoom(Round(0, 0, 10, 5, 0.4, 0), {6.5, 6.5});
  const Room t1 = builder.AddRoom(Round(-22, 46, 6.5, 3.5, 0.6, 0.5), {3.5, 3.5});
  const Room t2 = builder.AddRoom(Round(20, 58, 7, 4, 0.6, 0.5), {3.8, 3.8});
  const Room t3 = builder.AddRoom(Round(-8, 92, 6.5, 3, 0.6, 0.5), {3.5, 3.5});
  const Room u1 = builder.AddRoom(Rectangle(36, 0, {7, 5.5}), {4, 2.8});
  const Room u2 = builder.AddRoom(Rectangle(76, 2, {8, 6}), {4.5, 3});
  const Room u3 = builder.AddRoom(Rectangle(36, -38, {6, 7}), {3, 4});
  const Room u4 = builder.AddRoom(Rectangle(76, -38, {7, 5}), {4, 2.5});
  const Room c1 = builder.AddRoom(Round(-34, -16, 9, 6, 1.2, 1), {4.8, 4.8});
  const Room c2 = builder.AddRoom(Round(-76, -12, 10, 8, 1.2, 1), {5.5, 5.5});
  const Room c3 = builder.AddRoom(Round(-46, -58, 9, 5, 1.2, 1), {4.8, 4.8});

  const Space mine = Round(0, 0, 2.1, 2.8, 0.5, 0.6);
  builder.AddPassage(hall, {{-8, 17}, {-14, 32}}, t1, mine);
  builder.AddPassage(hall, {{8, 18}, {12, 34}, {20, 46}}, t2, mine);
  builder.AddPassage(t1, {{-4, 48}, {6, 54}}, t2, mine);
  builder.AddPassage(t1, {{-26, 62}, {-20, 80}}, t3, mine);
  builder.AddPassage(t2, {{22, 74}, {10, 86}}, t3, mine);
  const Space aisle = Round(0, 0, 1.5, 2.6, 0, 0);
  builder.AddPassage(hall, {{18, 0}}, u1, aisle);
  builder.AddPassage(u1, {{56, 0}}, u2, aisle);
  builder.AddPassage(u1, {{36, -18}}, u3, aisle);
  builder.AddPassage(u2, {{76, -18}}, u4, aisle);
  builder.AddPassage(u3, {{56, -38}}, u4, aisle);
  const Space gallery = Round(0, 0, 2.9, 4, 0.9, 0.9);
  builder.AddPassage(hall, {{-16, -7}}, c1, gallery);
  builder.AddPassage(c1, {{-50, -8}, {-62, -13}}, c2, gallery);
  builder.AddPassage(c2, {{-76, -30}, {-64, -46}}, c3, gallery);
  builder.AddPassage(c1, {{-38, -34}, {-44, -44}}, c3, gallery);
  builder.AddPassage(t2, {{40, 50}, {60, 38}, {74, 20}}, u2, mine);
  builder.AddPassage(u3, {{20, -48}, {-2, -56}, {-26, -60}}, c3, mine);
  builder.AddPassage(c2, {{-76, 10}, {-64, 30}, {-44, 42}}, t1, gallery);

  builder.AddPillar({1.5, 1}, {0.6, 0.6});
  builder.AddPillar({-2, -1.5}, {0.5, 0.5});
  builder.AddPillar({36, 0}, {0.9, 0.4});
  builder.AddPillar({76, 2}, {0.4, 0.4});
  builder.AddPillar({36, -38}, {0.4, 1.0});
  const std::vector<Space> spaces = builder.scene().plan.spaces;
  for (const Space& space : spaces) builder.Scatter(16, 0.5, 1.8, space);

  const NavigationGraph& graph = builder.graph();
  builder.scene().routes = {
      graph.Visit({hall[4], hall[1], t2[5], t2[2], t3[0], t3[3], t1[1], t1[4], hall[2], hall[5],
                   hall[1], t2[4], t2[2], t1[0], hall[3]}),
      graph.Visit({hall[2], hall[5], u1[3], u1[0], u2[3], u2[5], u4[1], u4[3], u3[0], u3[1], u1[4],
                   u1[2], hall[0], hall[3], hall[4], c1[0], hall[1], t2[4]}),
      graph.Visit({hall[0], hall[3], c1[0], c1[2], c2[0], c2[4], c3[2], c3[0], u3[3], u3[0], u1[4],
                   u1[1], hall[0], hall[2], t1[4], t1[0], t2[3], t2[5], hall[0]}),
      graph.Visit({hall[3], hall[0], u1[3], u1[0], u2[1], t2[0], t2[3], t1[0], t1[3], c2[1], c2[0],
                   c1[2], c1[0], hall[3], hall[0], u1[2], u1[5], u3[1]})};
  return builder.scene();
}

}  // namespace overtone
