// SPDX-License-Identifier: Apache-2.0
// The layouts behind MakeScene (scene.h), one file each.
#ifndef OVERTONE_CORE_SIMULATION_SCENES_H_
#define OVERTONE_CORE_SIMULATION_SCENES_H_

#include <cstdint>

#include "overtone/core/simulation/scene.h"

namespace overtone {

Scene MakeTunnelScene(uint64_t seed);
Scene MakeTerraceScene(uint64_t seed);
Scene MakeCorridorScene(uint64_t seed);
Scene MakeSubterraneanScene(uint64_t seed);

}  // namespace overtone

#endif  // OVERTONE_CORE_SIMULATION_SCENES_H_
