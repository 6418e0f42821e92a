// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/scene_builder.h"
#include "overtone/core/simulation/scenes.h"

namespace overtone {

// A store of crates in the west, a round hall of pillars in the east, 164 m of nothing in between.
Scene MakeCorridorScene(uint64_t seed) {
  SceneBuilder builder(seed);
  Space store_space;
  store_space.center = {-10, 0};
  store_space.half_size = {9, 7};
  store_space.height = 4;
  const Room store = builder.AddRoom(store_space, {5.5, 4});
  Space hall_space;
  hall_space.center = {172, 0};
  hall_space.radius = 10;
  hall_space.height = 5;
  hall_space.roughness = 0.5;
  const Room hall = builder.AddRoom(hall_space, {6, 6});

  Space corridor;
  corridor.radius = 1.5;
  corridor.height = 2.6;
  builder.AddPassage(store, {}, hall, corridor);
  // Where a sensor of 50 m sees neither end.
  builder.scene().corridor = Eigen::AlignedBox2d(Eigen::Vector2d(50, -2), Eigen::Vector2d(112, 2));

  builder.AddPillar({-11, 0.5}, {0.8, 0.4});
  builder.AddPillar({170.5, -1.5}, {0.6, 0.6});
  builder.AddPillar({173.5, 2}, {0.5, 0.5});
  builder.Scatter(60, 0.7, 2, store_space);
  builder.Scatter(60, 0.6, 1.5, hall_space);

  const NavigationGraph& graph = builder.graph();
  builder.scene().routes = {
      graph.Visit({store[1], store[3], store[5], hall[1], hall[5], store[1], store[3]}),
      graph.Visit({hall[2], hall[0], hall[4], store[5], store[1], hall[5], hall[1]})};
  return builder.scene();
}

}  // namespace overtone
