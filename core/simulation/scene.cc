// SPDX-License-Identifier: Apache-2.0
#include "overtone/core/simulation/scene.h"

#include <utility>

#include "absl/strings/str_cat.h"
#include "absl/strings/str_join.h"
#include "overtone/core/simulation/scenes.h"

namespace overtone {
namespace {

using Maker = Scene (*)(uint64_t seed);
constexpr std::pair<const char*, Maker> kScenes[] = {{"tunnel", MakeTunnelScene},
                                                     {"terrace", MakeTerraceScene},
                                                     {"corridor", MakeCorridorScene},
                                                     {"subterranean", MakeSubterraneanScene}};

}  // namespace

const std::vector<std::string>& SceneNames() {
  static const auto* const names = [] {
    auto* all = new std::vector<std::string>();
    for (const auto& [name, make] : kScenes) all->push_back(name);
    return all;
  }();
  return *names;
}

absl::StatusOr<Scene> MakeScene(absl::string_view name, uint64_t seed) {
  for (const auto& [known, make] : kScenes) {
    if (name == known) return make(seed);
  }
  return absl::InvalidArgumentError(
      absl::StrCat("no scene \"", name, "\", there are ", absl::StrJoin(SceneNames(), ", ")));
}

}  // namespace overtone
